#include "render/warp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"
#include "render/pattern_noise.h"

namespace oktett {
namespace {

constexpr double kPeriod = 1.00001;

Vec3d warped_by(const RepeatWarp& r, Vec3d p) {
  const int axis = r.width.x != 0 ? 0 : r.width.y != 0 ? 1 : 2;
  const double width = r.width[axis], copy = std::floor(p[axis] / width);
  if (!std::isfinite(copy)) return p;
  p[axis] -= copy * width;
  if (std::fmod(copy, 2) != 0)
    for (int k = 0; k < 3; ++k)
      if (r.flip[k] != 0) p[k] = k == axis ? width - p[k] : -p[k];
  return p + r.offset * copy;
}

Vec3d warped_by(const BlackHoleWarp& b, const Vec3d& p) {
  const Vec3d from_center = p - b.center;
  const double distance = length(from_center);
  if (!(distance < b.radius)) return p;
  const double depth = portable::pow((b.radius - distance) / b.radius, b.falloff);
  const double part = std::min(b.strength * depth, 1.0);
  return p + from_center * (b.inverse ? -part : part);
}

Vec3d warped_by(const TurbulenceWarp& t, const Vec3d& p) { return displaced(t.turbulence, p); }

/// The part of a turn from the first axis towards the second, in [0, 1).
double turn(double second, double first) {
  return fraction_of(portable::atan2(second, first) / (2 * std::numbers::pi));
}

Vec3d warped_by(const MappingWarp& m, const Vec3d& p) {
  using Figure = MappingWarp::Figure;
  double u = p.x, v = p.y, d = m.distance;
  const double across = std::sqrt(p.x * p.x + p.z * p.z);
  if (m.figure != Figure::planar) u = turn(p.z, p.x);
  if (m.figure == Figure::cylindrical) d = across;
  if (m.figure == Figure::spherical) {
    d = length(p);
    v = d > 0 ? 0.5 + portable::asin(std::clamp(p.y / d, -1.0, 1.0)) / std::numbers::pi : 0.5;
  }
  if (m.figure == Figure::toroidal) {
    const double out = across - m.major_radius;
    d = std::sqrt(out * out + p.y * p.y);
    v = turn(-p.y, -out);
  }
  if (m.exponent != 0 && m.figure != Figure::planar) {
    const double factor = portable::pow(d, m.exponent);
    u *= factor;
    if (m.figure != Figure::cylindrical) v *= factor;
  }
  // The axes of the pattern for each direction of the distance, weighted by its parts.
  const Vec3d& o = m.orientation;
  return Vec3d{d, v, -u} * o.x + Vec3d{u, -d, v} * o.y + Vec3d{u, v, d} * o.z;
}

Vec3d warped_by(const TransformWarp& t, const Vec3d& p) { return t.to_pattern.point(p); }

/// How octaves follow each other in POV-Ray, which keeps these numbers as floats.
struct OctaveSteps {
  explicit OctaveSteps(const PatternTurbulence& t)
      : lambda(static_cast<float>(t.lambda)), omega(static_cast<float>(t.omega)) {}
  double lambda, omega;
};

/// What is multiplied by the frequency and moved by the phase.
double phase_of(const Wave& wave, double value) { return value * wave.frequency + wave.phase; }

}  // namespace

Vec3d displaced(const PatternTurbulence& t, const Vec3d& p) {
  if (t.amount == Vec3d{0, 0, 0}) return p;
  Vec3d sum{0, 0, 0};
  double scale = 1, weight = 1;
  if (t.generator != NoiseGenerator::own) {
    const OctaveSteps steps(t);
    for (std::uint32_t i = 0; i < t.octaves; ++i, scale *= steps.lambda, weight *= steps.omega)
      sum += povray_noise_vector(p * scale) * weight;
    return p + sum * t.amount;
  }
  for_each_octave<3>(
      t.octaves, t.generator,
      [&](Vec3d(&places)[3]) {
        vector_noise_places(p * scale, places);
        scale *= t.lambda;
      },
      [&](const double(&noise)[3]) {
        sum += Vec3d{noise[0], noise[1], noise[2]} * weight;
        weight *= t.omega;
      });
  return p + sum * t.amount;
}

double value_turbulence(const PatternTurbulence& t, const Vec3d& p) {
  double sum = 0, scale = 1, weight = 1;
  if (t.generator != NoiseGenerator::own) {
    const OctaveSteps steps(t);
    for (std::uint32_t i = 0; i < t.octaves; ++i, scale *= steps.lambda, weight *= steps.omega) {
      const double noise = povray_noise(p * scale, t.generator);
      // Of the first octave alone what is beyond [0, 1] is cut off.
      sum += weight * (t.generator == NoiseGenerator::povray_1 ? noise
                       : i == 0                                ? steep_noise(2 * noise - 1)
                                                               : 2 * noise - 0.5);
    }
    return sum;
  }
  for_each_octave<1>(
      t.octaves, t.generator, [&](Vec3d(&place)[1]) { place[0] = p * scale, scale *= t.lambda; },
      [&](const double(&noise)[1]) { sum += steep_noise(noise[0]) * weight, weight *= t.omega; });
  return sum;
}

Vec3d warped(const Warp& warp, const Vec3d& p) {
  return std::visit([&](const auto& kind) { return warped_by(kind, p); }, warp);
}

Vec3d warped(const std::vector<Warp>& warps, Vec3d p) {
  for (std::size_t i = warps.size(); i-- > 0;) p = warped(warps[i], p);
  return p;
}

double period_of(const Wave& wave, double value) {
  return wave.frequency == 0 ? std::floor(value) : std::floor(phase_of(wave, value) / kPeriod);
}

double waved(const Wave& wave, WaveShape own, double value) {
  if (wave.frequency != 0) value = std::fmod(phase_of(wave, value), kPeriod);
  if (value < 0) value -= std::floor(value);
  // A NaN becomes 0.
  const double x = value > 0 ? std::min(value, 1.0) : 0;
  switch (wave.shape == WaveShape::own ? own : wave.shape) {
    case WaveShape::triangle:
      return x > 0.5 ? 2 - 2 * x : 2 * x;
    case WaveShape::sine:
      return 0.5 + 0.5 * portable::sin(2 * std::numbers::pi * x);
    case WaveShape::scallop:
      return std::abs(portable::sin(std::numbers::pi * x));
    case WaveShape::cubic:
      return x * x * (3 - 2 * x);
    case WaveShape::poly:
      return portable::pow(x, wave.exponent);
    default:
      return x;
  }
}

bool jumps(const Wave& wave, WaveShape own) {
  const WaveShape shape = wave.shape == WaveShape::own ? own : wave.shape;
  return shape == WaveShape::own || shape == WaveShape::ramp || shape == WaveShape::cubic ||
         shape == WaveShape::poly;
}

}  // namespace oktett
