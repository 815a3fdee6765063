/// \file Spheres, points, spots and what is infinitely far away.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/math.h"
#include "render/light/round_lanes.h"

namespace oktett {

// Spheres.

static double cap_height(double sine_square) { return only_lane(cap_height_lanes(Lane(sine_square))); }

std::optional<LightSample> sample_kind(const SphereEmitter& e, const LightPoint& p, const SquareSample& s) {
  const Vec3d to_center = Vec3d(e.center) - Vec3d(p.position);
  const double square = dot(to_center, to_center), r = e.radius, r_square = r * r;
  if (square >= r_square) {
    if (!(square > 0)) return std::nullopt;
    return only_sample(sample_spheres(broadcast<Lane>(to_center), Lane(r), Lane(s.x), Lane(s.y)), e.radiance);
  }
  if (!e.both_sides) return std::nullopt;
  const Vec3d direction = around({0, 0, 1}, 2 * s.x, s.y);
  const double along = dot(to_center, direction);
  const double distance = along + std::sqrt(along * along + (r_square - square));
  return sample_at(direction * distance, e.radiance, 1 / (4 * std::numbers::pi), false);
}

float pdf_kind(const SphereEmitter& e, const LightPoint& p, const Vec3f&, float) {
  const Vec3d to_center = Vec3d(e.center) - Vec3d(p.position);
  const double square = dot(to_center, to_center), r_square = double{e.radius} * e.radius;
  if (square >= r_square)
    return square > 0 ? static_cast<float>(1 / (2 * std::numbers::pi * cap_height(r_square / square))) : 0;
  return e.both_sides ? static_cast<float>(1 / (4 * std::numbers::pi)) : 0;
}

std::optional<LightBounds> bounds_kind(const SphereEmitter& e) {
  const double r = e.radius;
  const Vec3d half{r, r, r};
  return LightBounds{
      .box = {round_down(Vec3d(e.center) - half), round_up(Vec3d(e.center) + half)},
      .spread = static_cast<float>(std::numbers::pi),
      .reach = static_cast<float>(std::numbers::pi / 2),
      .power = r > 0 ? static_cast<float>(color_weight(e.radiance) * 4 * std::numbers::pi * r * r) : 0};
}

// Points and spots.

/// The sample of a point or a spot; `part` is what its profile leaves of the intensity.
static std::optional<LightSample> sample_cone(const LightCone& cone, const Color& intensity, float part,
                                              const LightPoint& p) {
  const Vec3d to = Vec3d(cone.position) - Vec3d(p.position);
  const PointSamples<Lane> s =
      sample_points(broadcast<Lane>(to), broadcast<Lane>(Vec3d(cone.axis)), Lane(cone.cos_inner),
                    Lane(cone.cos_outer), Lane::M::from_bits(cone.falls_off ? 1 : 0));
  std::optional<LightSample> sample = only_sample(s.at, intensity * only_lane(s.scale) * part);
  if (sample) sample->delta = true;
  return sample;
}

std::optional<LightSample> sample_kind(const PointEmitter& e, const LightPoint& p, const SquareSample&) {
  return sample_cone(light_cone(e), e.intensity, e.profile(Vec3d(p.position) - Vec3d(e.position)), p);
}

std::optional<LightSample> sample_kind(const SpotEmitter& e, const LightPoint& p, const SquareSample&) {
  return sample_cone(light_cone(e), e.intensity, 1, p);
}

float pdf_kind(const PointEmitter&, const LightPoint&, const Vec3f&, float) { return 0; }
float pdf_kind(const SpotEmitter&, const LightPoint&, const Vec3f&, float) { return 0; }

std::optional<LightBounds> bounds_kind(const PointEmitter& e) {
  if (!e.falloff) return std::nullopt;
  return LightBounds{.box = {e.position, e.position},
                     .spread = static_cast<float>(std::numbers::pi),
                     .reach = static_cast<float>(std::numbers::pi / 2),
                     .power = static_cast<float>(color_weight(e.intensity) / lit_part(std::numbers::pi))};
}

std::optional<LightBounds> bounds_kind(const SpotEmitter& e) {
  const double inner = portable::acos(std::clamp(double{e.cos_inner}, -1.0, 1.0));
  const double outer = portable::acos(std::clamp(double{e.cos_outer}, -1.0, 1.0));
  const double spread = std::max(std::min(inner, outer), outer - std::numbers::pi / 2);
  return LightBounds{.box = {e.position, e.position},
                     .axis = normalize(e.axis),
                     .spread = static_cast<float>(spread),
                     .reach = static_cast<float>(outer - spread),
                     .power = static_cast<float>(color_weight(e.intensity) / lit_part(spread))};
}

// Directional light and environments.

DirectionalEmitter::DirectionalEmitter(const Vec3f& towards, const Color& facing, float diameter)
    : direction(towards), irradiance(facing), angle(diameter) {
  if (!(angle > 0)) return;
  const double quarter = portable::sin(angle / 4.0), half = portable::sin(angle / 2.0);
  height = 2 * quarter * quarter;
  radiance = irradiance * static_cast<float>(1 / (std::numbers::pi * half * half));
  // A disk so small that its radiance is no float is seen as a point.
  if (!is_finite(radiance) || !std::isfinite(sun_pdf(*this))) angle = 0, height = 0, radiance = {};
}

float sun_pdf(const DirectionalEmitter& e) {
  return static_cast<float>(1 / (2 * std::numbers::pi * e.height));
}

static bool in_disk(const DirectionalEmitter& e, const Vec3f& direction) {
  // The square of the chord between the directions keeps its accuracy for small angles. Directions are
  // rounded, and those that were chosen in a very small disk must be found in it.
  constexpr double kRounding = 0x1p-23;
  const double longest = std::sqrt(2 * e.height) + kRounding;
  const Vec3d chord = Vec3d(direction) - Vec3d(e.direction);
  return dot(chord, chord) <= longest * longest;
}

std::optional<LightSample> sample_kind(const DirectionalEmitter& e, const LightPoint&,
                                       const SquareSample& s) {
  LightSample sample{.direction = e.direction,
                     .distance = std::numeric_limits<float>::infinity(),
                     .radiance = e.irradiance,
                     .pdf = 1,
                     .delta = true,
                     .emitter = 0,
                     .u = 0,
                     .v = 0};
  if (!(e.angle > 0)) return sample;
  sample.direction =
      only_lane(to_float(around_lanes(broadcast<Lane>(Vec3d(e.direction)), Lane(s.x * e.height), Lane(s.y))));
  sample.radiance = e.radiance;
  sample.pdf = sun_pdf(e);
  sample.delta = false;
  return sample;
}

float pdf_kind(const DirectionalEmitter& e, const LightPoint&, const Vec3f& direction, float) {
  return e.angle > 0 && in_disk(e, direction) ? sun_pdf(e) : 0;
}

std::optional<LightSample> sample_kind(const EnvironmentEmitter& e, const LightPoint&,
                                       const SquareSample& s) {
  if (!e.map || !e.map->samples()) return std::nullopt;
  const EnvironmentMap::Sample sample = e.map->sample(s);
  return LightSample{.direction = sample.direction,
                     .distance = std::numeric_limits<float>::infinity(),
                     .radiance = sample.radiance,
                     .pdf = sample.pdf,
                     .delta = false,
                     .emitter = 0,
                     .u = sample.u,
                     .v = sample.v};
}

float pdf_kind(const EnvironmentEmitter& e, const LightPoint&, const Vec3f& direction, float) {
  return e.map ? e.map->pdf(direction) : 0;
}

Color infinite_radiance(const Emitter& emitter, const Vec3f& direction) {
  if (const auto* e = std::get_if<EnvironmentEmitter>(&emitter))
    return e->map ? e->map->radiance(direction) : Color{};
  if (const auto* e = std::get_if<DirectionalEmitter>(&emitter))
    return e->angle > 0 && in_disk(*e, direction) ? e->radiance : Color{};
  return {};
}

double distant_irradiance(const Emitter& emitter) {
  if (const auto* e = std::get_if<EnvironmentEmitter>(&emitter))
    return e->map && e->map->samples() ? std::numbers::pi * e->map->mean_radiance() : 0;
  if (const auto* e = std::get_if<DirectionalEmitter>(&emitter)) return color_weight(e->irradiance);
  if (const auto* e = std::get_if<PointEmitter>(&emitter)) return e->falloff ? 0 : color_weight(e->intensity);
  return 0;
}

}  // namespace oktett
