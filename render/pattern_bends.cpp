/// \file How patterns with POV-Ray's noise bend surfaces there, found by asking it for pictures.

#include <cmath>
#include <numbers>
#include <optional>

#include "core/math.h"
#include "core/povray_noise.h"
#include "render/pattern.h"
#include "render/pattern_noise.h"
#include "render/pattern_values.h"

namespace oktett {
namespace {

double sine(double turns) { return portable::sin(2 * std::numbers::pi * fraction_of(turns)); }

/// The sum of what waves from all sources add, each along its own way: height(distance, frequency).
template <class Height>
Vec3d sum_of_waves(std::uint32_t sources, const Vec3d& p, const Height& height) {
  Vec3d sum{0, 0, 0};
  for (std::uint32_t i = 0; i < sources; ++i) {
    const PovrayWave wave = povray_wave(i);
    const Vec3d way = p - wave.source;
    const double distance = length(way);
    if (distance > 0) sum += way * (height(distance, wave.frequency) / (distance * sources));
  }
  return sum;
}

Vec3d bend(const BumpsPattern&, const Vec3d& p, const PatternFrame&) { return povray_noise_vector(p); }

Vec3d bend(const DentsPattern& d, const Vec3d& p, const PatternFrame& frame) {
  return povray_noise_vector(p) * raw_value(d, p, frame);
}

Vec3d bend(const QuiltedPattern& q, const Vec3d& p, const PatternFrame&) {
  const Vec3d from_middle = from_cushion_middle(p);
  return from_middle * (cushion_curve(q, length(from_middle)) * 2 / std::numbers::sqrt3);
}

Vec3d bend(const RipplesPattern& r, const Vec3d& p, const PatternFrame& frame) {
  return sum_of_waves(r.sources, p, [&](double distance, double) {
    return sine(distance * frame.wave.frequency + frame.wave.phase);
  });
}

Vec3d bend(const WavesPattern& w, const Vec3d& p, const PatternFrame& frame) {
  return sum_of_waves(w.sources, p, [&](double distance, double own) {
    return sine(distance * own * frame.wave.frequency + frame.wave.phase) / own;
  });
}

Vec3d bend(const WrinklesPattern&, const Vec3d& p, const PatternFrame&) {
  Vec3d sum{0, 0, 0};
  double scale = 1;
  for (int octave = 0; octave < 10; ++octave, scale *= 2) {
    const Vec3d noise = povray_noise_vector(p * scale);
    sum += Vec3d{std::abs(noise.x), std::abs(noise.y), std::abs(noise.z)} / scale;
  }
  return sum;
}

}  // namespace

std::optional<Vec3d> povray_bend(const Pattern& pattern, const Vec3d& p, const PatternFrame& frame) {
  return std::visit(
      [&](const auto& kind) -> std::optional<Vec3d> {
        if constexpr (requires { bend(kind, p, frame); }) return bend(kind, p, frame);
        return std::nullopt;
      },
      pattern);
}

}  // namespace oktett
