#pragma once
/// \file What several kinds of emitters have in common.

#include <cmath>
#include <optional>

#include "render/light/emitter.h"

namespace oktett {

/// Below this solid angle flat emitters are sampled by area: it hardly differs, and is exact.
inline constexpr double kLeastSolidAngle = 1e-6;

/// What points and spots have in common: the light of a point goes everywhere.
struct LightCone {
  Vec3f position, axis;
  float cos_inner, cos_outer;
  bool falls_off;  ///< with the square of the distance
};
inline LightCone light_cone(const SpotEmitter& e) {
  return {e.position, e.axis, e.cos_inner, e.cos_outer, e.falloff};
}
inline LightCone light_cone(const PointEmitter& e) { return {e.position, {0, 0, 0}, -2, -3, e.falloff}; }

/// The density of directions to the disk of a sun of some size.
float sun_pdf(const DirectionalEmitter& e);

/// The unit vector at an angle from the unit vector `axis` whose cosine is 1 - `one_minus_cos`. `turn` in [0,
/// 1) goes once around.
Vec3d around(const Vec3d& axis, double one_minus_cos, double turn);

/// A sample at the end of `to`, the vector from the point. Nothing if pdf or distance are 0, infinite or NaN,
/// or the light is not finite.
inline std::optional<LightSample> sample_at(const Vec3d& to, const Color& radiance, double pdf, bool delta,
                                            double u = 0, double v = 0) {
  const double length_of_to = length(to);
  const auto distance = static_cast<float>(length_of_to), density = static_cast<float>(pdf);
  const auto usable = [](float x) { return x > 0 && std::isfinite(x); };
  if (!usable(distance) || !usable(density) || !is_finite(radiance)) return std::nullopt;
  return LightSample{.direction = Vec3f(to / length_of_to),
                     .distance = distance,
                     .radiance = radiance,
                     .pdf = density,
                     .delta = delta,
                     .emitter = 0,
                     .u = static_cast<float>(u),
                     .v = static_cast<float>(v)};
}

}  // namespace oktett
