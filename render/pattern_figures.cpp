/// \file Patterns of closed forms. The forms are those of POV-Ray, found by asking it for values.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"
#include "core/random.h"
#include "kernels/functions/tape_data.h"
#include "render/pattern.h"
#include "render/pattern_noise.h"
#include "render/pattern_values.h"

namespace oktett {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// From 1 at 0 to 0 at 1 and beyond.
double down(double distance) { return std::max(1 - distance, 0.0); }

double hypotenuse(double x, double y) { return std::sqrt(x * x + y * y); }

double sine_wave(double x) { return 0.5 + 0.5 * portable::sin(kTurn * fraction_of(x)); }

double triangle(double x) {
  const double part = fraction_of(x);
  return part > 0.5 ? 2 - 2 * part : 2 * part;
}

/// A random direction of unit length, uniform on the sphere.
Vec3d random_direction(std::uint32_t index) {
  const std::uint64_t bits = mix_bits((index + std::uint64_t{1}) * kGoldenBits);
  const double height = 2 * unit_of(bits) - 1, angle = kTurn * unit_of(mix_bits(bits + kGoldenBits));
  const double across = std::sqrt(std::max(0.0, 1 - height * height));
  return {across * portable::cos(angle), height, across * portable::sin(angle)};
}

/// Turns about z times `arms`, which count from -y.
double arm_turns(double arms, const Vec3d& p) { return arms * (portable::atan2(p.y, p.x) / kTurn + 0.25); }

/// What a spiral adds to the rings about z.
double screw(double arms, const Vec3d& p, const PatternTurbulence& t) {
  const double noise = t.amount.x == 0 ? 0 : t.amount.x * value_turbulence(t, p);
  return p.z + noise + arm_turns(arms, p);
}

}  // namespace

double raw_value(const AngularPattern&, const Vec3d& p, const PatternFrame&) {
  if (p.x == 0 && p.z == 0) return 0.25;
  return 0.75 + portable::atan2(p.x, p.z) / kTurn;
}

double raw_value(const BoxedPattern&, const Vec3d& p, const PatternFrame&) {
  return down(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}));
}

double raw_value(const CylindricalPattern&, const Vec3d& p, const PatternFrame&) {
  return down(hypotenuse(p.x, p.z));
}

double raw_value(const FunctionPattern& f, const Vec3d& p, const PatternFrame& frame) {
  if (f.texture == TextureIndex{}) return value_at(f.function, p.x, p.y, p.z);
  const Color c = frame.others == nullptr ? Color{0, 0, 0} : frame.others->color(f.texture.index, p);
  return value_at(f.function, double{c.x}, double{c.y}, double{c.z});
}

double raw_value(const LayersPattern&, const Vec3d& p, const PatternFrame& frame) {
  const PatternTurbulence& t = frame.turbulence;
  return t.amount.x == 0 ? p.x : p.x + t.amount.x * value_turbulence(t, p);
}

double raw_value(const LeopardPattern&, const Vec3d& p, const PatternFrame&) {
  const double mean = (portable::sin(p.x) + portable::sin(p.y) + portable::sin(p.z)) / 3;
  return mean * mean;
}

double raw_value(const LinearPattern& l, const Vec3d& p, const PatternFrame&) {
  const double along = dot(p, l.direction) / length(l.direction);
  return along > 1 ? fraction_of(along) : along;
}

double raw_value(const OnionPattern&, const Vec3d& p, const PatternFrame&) { return fraction_of(length(p)); }

double raw_value(const PlanarPattern&, const Vec3d& p, const PatternFrame&) { return down(std::abs(p.y)); }

Vec3d from_cushion_middle(const Vec3d& p) {
  return {fraction_of(p.x) - 0.5, fraction_of(p.y) - 0.5, fraction_of(p.z) - 0.5};
}

double cushion_curve(const QuiltedPattern& q, double distance) {
  const double t = distance, s = 1 - t;
  return t * (3 * s * (s * q.control0 + t * q.control1) + t * t);
}

double raw_value(const QuiltedPattern& q, const Vec3d& p, const PatternFrame&) {
  const Vec3d from_middle = from_cushion_middle(p);
  // The curve times the sum of the axes; 1 would be the value where both the distance and the axes are
  // 1 / sqrt(3) times 3 / 2.
  const double curve = cushion_curve(q, length(from_middle));
  const double sum = std::abs(from_middle.x) + std::abs(from_middle.y) + std::abs(from_middle.z);
  return sum * curve * (2 / (3 * std::numbers::sqrt3));
}

double raw_value(const RingsPattern&, const Vec3d& p, const PatternFrame& frame) {
  const PatternTurbulence& t = frame.turbulence;
  if (t.amount == Vec3d{0, 0, 0}) return hypotenuse(p.x, p.y);
  PatternTurbulence whole = t;
  whole.amount = {1, 1, 1};
  const Vec3d q = displaced(whole, p);
  const double x = p.x + portable::sin(kTurn * fraction_of(q.x * t.amount.x));
  const double y = p.y + portable::sin(kTurn * fraction_of(q.y * t.amount.y));
  return hypotenuse(x, y);
}

double raw_value(const RipplesPattern& r, const Vec3d& p, const PatternFrame& frame) {
  const bool own = frame.turbulence.generator == NoiseGenerator::own;
  double sum = 0;
  for (std::uint32_t i = 0; i < r.sources; ++i) {
    const Vec3d source = own ? random_direction(i) : povray_wave(i).source;
    sum += sine_wave(length(p - source) * frame.wave.frequency + frame.wave.phase);
  }
  return sum / r.sources;
}

double raw_value(const WavesPattern& w, const Vec3d& p, const PatternFrame& frame) {
  const bool own = frame.turbulence.generator == NoiseGenerator::own;
  double sum = 0;
  for (std::uint32_t i = 0; i < w.sources; ++i) {
    const PovrayWave wave =
        own ? PovrayWave{random_direction(i), unit_of(mix_bits((i + std::uint64_t{1}) * kGoldenBits + 1))}
            : povray_wave(i);
    const double height =
        sine_wave(length(p - wave.source) * wave.frequency * frame.wave.frequency + frame.wave.phase);
    // In POV-Ray the slow waves are the high ones.
    sum += own ? height : (2 * height - 1) / wave.frequency;
  }
  return own ? sum / w.sources : 0.2 * (2.5 + sum / w.sources);
}

double raw_value(const SphericalPattern&, const Vec3d& p, const PatternFrame&) { return down(length(p)); }

double raw_value(const SpiralPattern& s, const Vec3d& p, const PatternFrame& frame) {
  return hypotenuse(p.x, p.y) + screw(s.arms, p, frame.turbulence);
}

double raw_value(const DoubleSpiralPattern& s, const Vec3d& p, const PatternFrame& frame) {
  const double ring = hypotenuse(p.x, p.y);
  return triangle(ring) + triangle(ring + screw(s.arms, p, frame.turbulence));
}

double raw_value(const TexturePattern& t, const Vec3d& p, const PatternFrame& frame) {
  if (frame.others == nullptr) return 0;
  const Color c = frame.others->color(t.texture.index, p);
  return 0.297 * double{c.x} + 0.589 * double{c.y} + 0.114 * double{c.z};
}

/// From 1, where both point the same way, to 0; 1/2 if one is zero.
static double likeness(const Vec3d& a, const Vec3d& b) {
  const double size = length(a) * length(b);
  if (!(size > 0)) return 0.5;
  const double cosine = std::clamp(dot(a, b) / size, -1.0, 1.0);
  return 1 - portable::atan2(std::sqrt((1 - cosine) * (1 + cosine)), cosine) / std::numbers::pi;
}

double raw_value(const IncidencePattern&, const Vec3d&, const PatternFrame& frame) {
  if (frame.others == nullptr) return 0.5;
  return likeness(frame.others->normal(), frame.others->to_viewer());
}

double raw_value(const SlopePattern& s, const Vec3d& p, const PatternFrame& frame) {
  const Vec3d normal = frame.others == nullptr ? Vec3d{0, 0, 0} : frame.others->normal();
  const double slope = (likeness(normal, s.direction) - s.low) / (s.high - s.low);
  const double weight = length(s.altitude);
  if (weight == 0) return slope;
  const double height = (dot(p, s.altitude) / weight - s.altitude_low) / (s.altitude_high - s.altitude_low);
  const double all = length(s.direction);
  return (slope * all + height * weight) / (all + weight);
}

double raw_value(const VoxelPattern& v, const Vec3d& p, const PatternFrame&) {
  if (v.grid == nullptr) return 0;
  Vec3d place;
  for (int k = 0; k < 3; ++k) {
    if (!(p[k] >= 0 && p[k] <= 1)) return 0;
    place[k] = p[k] * (v.grid->size(k) - 1);
    if (!v.smooth) place[k] = std::floor(place[k]);
  }
  return v.grid->at(place);
}

}  // namespace oktett
