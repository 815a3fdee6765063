#include "render/light/emitter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/math.h"
#include "render/light/emitter_lanes.h"
#include "render/light/light_share.h"

namespace oktett {

// ---- A profile on an emitter that points somewhere.

float AimedProfile::operator()(const Vec3d& direction) const {
  if (profile == nullptr) return 1;
  const double x = dot(direction, zero), y = dot(direction, cross(zero, down)), z = dot(direction, down);
  double horizontal = portable::atan2(y, x) / kDegree;
  if (horizontal < 0) horizontal += 360;
  const double vertical = portable::atan2(std::sqrt(x * x + y * y), z) / kDegree;
  return static_cast<float>(profile_value(*profile, vertical, horizontal));
}

AimedProfile aim(std::shared_ptr<const LightProfile> profile, const Vec3d& down, double rotation) {
  AimedProfile aimed{std::move(profile), normalize(down), {}};
  const double angle = rotation * kDegree;
  const Vec3d zero{portable::cos(angle), 0, -portable::sin(angle)};
  // The rotation that takes -y to `down` (Rodrigues). If that is +y, half a turn about x.
  const Vec3d axis = cross(Vec3d{0, -1, 0}, aimed.down);
  const double cosine = -aimed.down.y;
  if (cosine < -1 + 1e-12) {
    aimed.zero = {zero.x, 0, -zero.z};
    return aimed;
  }
  const Vec3d once = cross(axis, zero);
  aimed.zero = normalize(zero + once + cross(axis, once) * (1 / (1 + cosine)));
  return aimed;
}

// ---- Emitters.

float color_weight(const Color& c) {
  if (!is_finite(c)) return 0;
  const auto part = [](float x) { return x > 0 ? double{x} : 0; };
  const auto mean = static_cast<float>((part(c.x) + part(c.y) + part(c.z)) / 3);
  return std::isfinite(mean) ? mean : 0;
}

Vec3d around(const Vec3d& axis, double one_minus_cos, double turn) {
  return only_lane(around_lanes(broadcast<Lane>(axis), Lane(one_minus_cos), Lane(turn)));
}

std::optional<LightSample> only_sample(const LightSamples<Lane>& s, const Color& radiance) {
  if (none(s.found) || !is_finite(radiance)) return std::nullopt;
  return LightSample{.direction = only_lane(s.direction),
                     .distance = only_lane(s.distance),
                     .radiance = radiance,
                     .pdf = only_lane(s.pdf),
                     .delta = false,
                     .emitter = 0,
                     .u = static_cast<float>(only_lane(s.u)),
                     .v = static_cast<float>(only_lane(s.v))};
}

/// The density, per solid angle, of directions from a point of a sphere into it.
static constexpr double kInwardPdf = 1 / (2 * std::numbers::pi);

std::optional<LightSample> sample_own_emitter(const Emitter& emitter, const LightPoint& point,
                                              const SquareSample& s) {
  const auto* sphere = std::get_if<SphereEmitter>(&emitter);
  if (sphere == nullptr || !sphere->both_sides) return std::nullopt;
  const Vec3d inward = normalize(Vec3d(sphere->center) - Vec3d(point.position));
  const Vec3d chord = around(inward, s.x, s.y) * (2 * (1 - s.x) * double{sphere->radius});
  return sample_at(chord, sphere->radiance, kInwardPdf, false);
}

float own_emitter_pdf(const Emitter& emitter) {
  const auto* sphere = std::get_if<SphereEmitter>(&emitter);
  return sphere != nullptr && sphere->both_sides ? static_cast<float>(kInwardPdf) : 0;
}

// Triangles, parallelograms and disks.

/// The emitter as seen from the point.
template <class Flat>
static auto view_from(const LightPoint& p, const Flat& e) {
  const void* const only = &e;
  return view(EmitterLanes<Lane, Flat>{&only}, broadcast<Lane>(Vec3d(p.position)));
}

template <class Flat>
static std::optional<LightSample> sample_kind(const Flat& e, const LightPoint& p, const SquareSample& s) {
  return only_sample(view_from(p, e).sample(Lane(s.x), Lane(s.y)), e.radiance);
}

/// At the end of the vector that leads to what a ray meets.
template <class Flat>
static float pdf_kind(const Flat& e, const LightPoint& p, const Vec3f& direction, float distance) {
  const auto to = broadcast<Lane>(Vec3d(direction) * double{distance});
  return static_cast<float>(only_lane(view_from(p, e).pdf(to)));
}

/// The bounds of a flat thing.
static LightBounds flat_bounds(const Box& box, const Vec3d& normal, double area, const Color& radiance,
                               bool both_sides) {
  return {.box = box,
          .axis = Vec3f(normalize(normal)),
          .spread = 0,
          .reach = static_cast<float>(std::numbers::pi / 2),
          .both_sides = both_sides,
          .power = static_cast<float>(color_weight(radiance) * area)};
}

static std::optional<LightBounds> bounds_kind(const TriangleEmitter& e) {
  const Vec3d normal = cross(Vec3d(e.b) - Vec3d(e.a), Vec3d(e.c) - Vec3d(e.a));
  Box box;
  for (const Vec3f& corner : {e.a, e.b, e.c}) box.grow(corner);
  return flat_bounds(box, normal, length(normal) / 2, e.radiance, e.both_sides);
}

static std::optional<LightBounds> bounds_kind(const RectangleEmitter& e) {
  const Vec3d normal = cross(Vec3d(e.edge_u), Vec3d(e.edge_v));
  Box box;
  for (const Vec3f& corner :
       {e.corner, e.corner + e.edge_u, e.corner + e.edge_v, e.corner + e.edge_u + e.edge_v})
    box.grow(corner);
  return flat_bounds(box, normal, length(normal), e.radiance, e.both_sides);
}

static std::optional<LightBounds> bounds_kind(const DiskEmitter& e) {
  const Vec3d n = normalize(Vec3d(e.normal));
  const double r = e.radius;
  const Vec3d half{r * std::sqrt(std::max(0.0, 1 - n.x * n.x)), r * std::sqrt(std::max(0.0, 1 - n.y * n.y)),
                   r * std::sqrt(std::max(0.0, 1 - n.z * n.z))};
  const Box box{round_down(Vec3d(e.center) - half), round_up(Vec3d(e.center) + half)};
  return flat_bounds(box, n, r > 0 ? std::numbers::pi * r * r : 0, e.radiance, e.both_sides);
}

// Spheres.

static double cap_height(double sine_square) { return only_lane(cap_height_lanes(Lane(sine_square))); }

static std::optional<LightSample> sample_kind(const SphereEmitter& e, const LightPoint& p,
                                              const SquareSample& s) {
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

static float pdf_kind(const SphereEmitter& e, const LightPoint& p, const Vec3f&, float) {
  const Vec3d to_center = Vec3d(e.center) - Vec3d(p.position);
  const double square = dot(to_center, to_center), r_square = double{e.radius} * e.radius;
  if (square >= r_square)
    return square > 0 ? static_cast<float>(1 / (2 * std::numbers::pi * cap_height(r_square / square))) : 0;
  return e.both_sides ? static_cast<float>(1 / (4 * std::numbers::pi)) : 0;
}

static std::optional<LightBounds> bounds_kind(const SphereEmitter& e) {
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

static std::optional<LightSample> faded(const LightFade& fade, std::optional<LightSample> sample) {
  if (sample && fade.fades()) sample->radiance *= faded_share(fade, sample->distance);
  return sample;
}

static std::optional<LightSample> sample_kind(const PointEmitter& e, const LightPoint& p,
                                              const SquareSample&) {
  const float part = e.profile(Vec3d(p.position) - Vec3d(e.position));
  return faded(e.fade, sample_cone(light_cone(e), e.intensity, part, p));
}

static std::optional<LightSample> sample_kind(const SpotEmitter& e, const LightPoint& p,
                                              const SquareSample&) {
  std::optional<LightSample> sample = faded(e.fade, sample_cone(light_cone(e), e.intensity, 1, p));
  if (sample) sample->radiance *= tight_share(-dot(Vec3d(sample->direction), Vec3d(e.axis)), e.tightness);
  return sample;
}

static float pdf_kind(const PointEmitter&, const LightPoint&, const Vec3f&, float) { return 0; }
static float pdf_kind(const SpotEmitter&, const LightPoint&, const Vec3f&, float) { return 0; }

static std::optional<LightBounds> bounds_kind(const PointEmitter& e) {
  if (!e.falloff) return std::nullopt;
  return LightBounds{.box = {e.position, e.position},
                     .spread = static_cast<float>(std::numbers::pi),
                     .reach = static_cast<float>(std::numbers::pi / 2),
                     .power = static_cast<float>(color_weight(e.intensity) / lit_part(std::numbers::pi))};
}

static std::optional<LightBounds> bounds_kind(const SpotEmitter& e) {
  if (!e.falloff) return std::nullopt;
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

static std::optional<LightSample> sample_kind(const DirectionalEmitter& e, const LightPoint&,
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

static float pdf_kind(const DirectionalEmitter& e, const LightPoint&, const Vec3f& direction, float) {
  return e.angle > 0 && in_disk(e, direction) ? sun_pdf(e) : 0;
}

static std::optional<LightSample> sample_kind(const EnvironmentEmitter& e, const LightPoint&,
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

static float pdf_kind(const EnvironmentEmitter& e, const LightPoint&, const Vec3f& direction, float) {
  return e.map ? e.map->pdf(direction) : 0;
}

// Emitters of any kind.

std::optional<LightSample> sample_emitter(const Emitter& emitter, const LightPoint& point,
                                          const SquareSample& s) {
  return std::visit([&](const auto& e) { return sample_kind(e, point, s); }, emitter);
}

float emitter_pdf(const Emitter& emitter, const LightPoint& point, const Vec3f& direction, float distance) {
  const float pdf =
      std::visit([&](const auto& e) { return pdf_kind(e, point, direction, distance); }, emitter);
  return pdf > 0 && std::isfinite(pdf) ? pdf : 0;
}

Vec3d normal_at(const Emitter& emitter, const Vec3d& place) {
  if (const auto* e = std::get_if<TriangleEmitter>(&emitter))
    return cross(Vec3d(e->b) - Vec3d(e->a), Vec3d(e->c) - Vec3d(e->a));
  if (const auto* e = std::get_if<RectangleEmitter>(&emitter))
    return cross(Vec3d(e->edge_u), Vec3d(e->edge_v));
  if (const auto* e = std::get_if<DiskEmitter>(&emitter)) return Vec3d(e->normal);
  if (const auto* e = std::get_if<SphereEmitter>(&emitter)) return place - Vec3d(e->center);
  return {};
}

std::optional<LightBounds> light_bounds(const Emitter& emitter) {
  const auto bounds = std::visit(
      [](const auto& e) -> std::optional<LightBounds> {
        if constexpr (requires { bounds_kind(e); }) return bounds_kind(e);
        return std::nullopt;
      },
      emitter);
  if (!bounds || !(bounds->power > 0) || !std::isfinite(bounds->power)) return std::nullopt;
  const bool finite = is_finite(bounds->box.lo) && is_finite(bounds->box.hi) && is_finite(bounds->axis) &&
                      std::isfinite(bounds->spread) && std::isfinite(bounds->reach);
  return finite ? bounds : std::nullopt;
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
  if (const auto* e = std::get_if<SpotEmitter>(&emitter)) return e->falloff ? 0 : color_weight(e->intensity);
  return 0;
}

}  // namespace oktett
