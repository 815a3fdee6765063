#include "render/photon/photon_source.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "accel/accel_data.h"
#include "accel/geometry_bounds.h"
#include "core/math.h"
#include "render/bsdf/principled/base.h"
#include "render/hit_object.h"
#include "render/light/emitter_kinds.h"
#include "render/light/light_share.h"
#include "render/sampling/warp.h"

namespace oktett {

// ---- Which surfaces make caustics, and where they are.

/// Whether a number that a texture may multiply can be below `limit`.
static bool may_be_below(double value, std::uint32_t texture, double limit) {
  return texture != kNoId || !(value >= limit);
}

bool may_cast(const Material& m) {
  if (!m.principled) return m.reflection != 0 || m.transparency != 0;
  const PrincipledMaterial& p = *m.principled;
  if (may_be_below(p.parameters.roughness, p.roughness_texture, kLeastRoughness)) return true;
  if (p.parameters.coat != 0 &&
      may_be_below(p.parameters.coat_roughness, p.coat_roughness_texture, kLeastRoughness))
    return true;
  // Glass that hardly bends light is smooth whatever its roughness. What lies around it may be as dense.
  return p.parameters.transmission != 0 && (m.priority != kNoPriority || p.ior_texture != kNoId ||
                                            std::abs(p.parameters.ior - 1) < 2 * kLeastIorDifference);
}

namespace {

class CasterSearch {
 public:
  explicit CasterSearch(const World& world) : world_(world) {
    for (const Material& m : world.materials) casts_.push_back(may_cast(m));
  }

  Casters find() {
    if (std::find(casts_.begin(), casts_.end(), true) == casts_.end()) return {};
    for (const Geometry& g : world_.accel->geometries) {
      if (!casts(g, kNoId)) continue;
      const Box box = geometry_bounds(g);
      if (!box.empty()) found_.bounds.grow(box);
      if (is_unbounded(g)) found_.unbounded = true;
    }
    return found_;
  }

 private:
  /// Whether a material of the object casts.
  bool casts(std::uint32_t user) const {
    if (casts_[material_index(world_, user, 0)]) return true;
    if (user >= world_.objects.size() || world_.objects[user].material != kNoId) return false;
    for (std::uint32_t slot = 1; slot < world_.objects[user].slots.size(); ++slot)
      if (casts_[material_index(world_, user, slot)]) return true;
    return false;
  }

  /// `outer`: the `user` of the outermost instance that has one.
  bool casts(const Geometry& g, std::uint32_t outer) {
    const std::uint32_t user = outer != kNoId ? outer : g.user;
    if (const auto* instance = std::get_if<InstanceGeometry>(&g.shape)) return casts(*instance->child, user);
    if (const auto* list = std::get_if<InstanceList>(&g.shape))
      return std::any_of(list->places.begin(), list->places.end(), [&](const InstancePlace& place) {
        return casts(*list->children[place.child], user != kNoId ? user : place.user);
      });
    if (const auto* csg = std::get_if<CsgGeometry>(&g.shape)) return casts(*csg->expression, user);
    return casts(user);
  }

  bool casts(const CsgExpression& expression, std::uint32_t outer) {
    return std::any_of(expression.solids.begin(), expression.solids.end(),
                       [&](const Geometry& solid) { return casts(solid, outer); }) ||
           std::any_of(expression.children.begin(), expression.children.end(),
                       [&](const CsgExpression& child) { return casts(child, outer); });
  }

  /// A structure that many instances show is looked at once.
  bool casts(const Accel& accel, std::uint32_t outer) {
    if (outer != kNoId) return casts(outer);
    const auto known = structures_.find(&accel);
    if (known != structures_.end()) return known->second;
    const bool any = std::any_of(accel.geometries.begin(), accel.geometries.end(),
                                 [&](const Geometry& g) { return casts(g, kNoId); });
    return structures_[&accel] = any;
  }

  const World& world_;
  std::vector<bool> casts_;  ///< by material
  std::map<const Accel*, bool> structures_;
  Casters found_;
};

}  // namespace

Casters find_casters(const World& world) { return CasterSearch(world).find(); }

// ---- Photons of lights.

namespace {

using Target = PhotonSource::Target;

/// A choice of directions from one place: uniform over the cone around the target, or over all directions.
struct Cone {
  Vec3d axis{0, 0, 1};
  double height = 2;  ///< 1 - cosine of half the angle
  bool everywhere = true;

  Cone(const Vec3d& from, const std::optional<Target>& target) {
    if (!target) return;
    const Vec3d to = target->center - from;
    const double square = dot(to, to), sine_square = target->radius * target->radius / square;
    if (!(sine_square < 1)) return;
    axis = to / std::sqrt(square);
    height = sine_square / (1 + std::sqrt(1 - sine_square));
    everywhere = false;
  }

  double solid_angle() const { return 2 * std::numbers::pi * height; }
  Vec3d direction(const SquareSample& s) const { return around(axis, s.x * height, s.y); }
};

/// A place on an area that glows.
struct GlowingPlace {
  Vec3d position, normal;  ///< the normal points to the side that glows
  double area;
  float u = 0, v = 0;  ///< as in LightSample
};

GlowingPlace place_on(const TriangleEmitter& e, const SquareSample& s) {
  const Vec3d a(e.a), ab = Vec3d(e.b) - a, ac = Vec3d(e.c) - a, n = cross(ab, ac);
  const double root = std::sqrt(s.x), u = root * (1 - s.y), v = root * s.y;
  return {a + ab * u + ac * v, normalize(n), length(n) / 2, static_cast<float>(u), static_cast<float>(v)};
}

GlowingPlace place_on(const RectangleEmitter& e, const SquareSample& s) {
  const Vec3d u(e.edge_u), v(e.edge_v), n = cross(u, v);
  return {Vec3d(e.corner) + u * s.x + v * s.y, normalize(n), length(n), static_cast<float>(s.x),
          static_cast<float>(s.y)};
}

GlowingPlace place_on(const DiskEmitter& e, const SquareSample& s) {
  const Vec3d n = normalize(Vec3d(e.normal));
  Vec3d tangent, bitangent;
  make_basis(n, tangent, bitangent);
  const double radius = e.radius * std::sqrt(s.x), angle = 2 * std::numbers::pi * s.y;
  return {Vec3d(e.center) + tangent * (radius * portable::cos(angle)) +
              bitangent * (radius * portable::sin(angle)),
          n, std::numbers::pi * e.radius * e.radius};
}

GlowingPlace place_on(const SphereEmitter& e, const SquareSample& s) {
  const Vec3d n = around({0, 0, 1}, 2 * s.x, s.y);
  return {Vec3d(e.center) + n * double{e.radius}, n, 4 * std::numbers::pi * e.radius * e.radius};
}

/// A ray that starts off the surface of an emitter, whose place is known to some units in the last place
/// only.
Ray ray_from(const Vec3d& position, const Vec3d& normal, const Vec3d& direction) {
  const double blur = 0x1p-20 * max_component(abs(position)) + 0x1p-100;
  Ray ray;
  ray.origin = Vec3f(position + normal * (dot(normal, direction) < 0 ? -blur : blur));
  ray.direction = Vec3f(direction);
  return ray;
}

template <class Area>
std::optional<PhotonStart> emit_area(const Area& e, const std::optional<Target>& target, double side,
                                     const SquareSample& where, const SquareSample& s, GlowingPlace& place) {
  place = place_on(e, where);
  const Cone cone(place.position, target);
  if (cone.everywhere) {
    Vec3d n = place.normal;
    if (e.both_sides && side < 0.5) n = -n;
    const double power = std::numbers::pi * place.area * (e.both_sides ? 2 : 1);
    return PhotonStart{ray_from(place.position, n, Vec3d(cosine_direction(Vec3f(n), s))),
                       e.radiance * static_cast<float>(power)};
  }
  const Vec3d direction = cone.direction(s);
  const double cosine = dot(direction, place.normal);
  if (!(cosine > 0) && !e.both_sides) return std::nullopt;
  return PhotonStart{ray_from(place.position, place.normal, direction),
                     e.radiance * static_cast<float>(std::abs(cosine) * place.area * cone.solid_angle())};
}

PhotonStart emit_from_point(const Vec3f& position, const Vec3d& direction, const Color& power) {
  PhotonStart start;
  start.ray.origin = position, start.ray.direction = Vec3f(direction);
  start.power = power;
  return start;
}

/// The directions into which a spot sends light to the target.
Cone cone_of(const SpotEmitter& e, const std::optional<Target>& target) {
  Cone cone(Vec3d(e.position), target);
  // The spot's own cone, if that is narrower.
  if (const double height = 1 - double{e.cos_outer}; height < cone.height)
    cone.axis = Vec3d(e.axis), cone.height = height;
  return cone;
}

Color intensity(const SpotEmitter& e, const Vec3d& direction) {
  const double cosine = dot(Vec3d(e.axis), direction);
  if (!(cosine > e.cos_outer)) return {};
  const double t = cosine >= e.cos_inner ? 1 : (cosine - e.cos_outer) / (double{e.cos_inner} - e.cos_outer);
  return e.intensity * (static_cast<float>(t * t * (3 - 2 * t)) * tight_share(cosine, e.tightness));
}

double area_weight(const Color& radiance, double area, bool both, const Vec3d& center,
                   const std::optional<Target>& target) {
  const Cone cone(center, target);
  const double angle = cone.everywhere ? std::numbers::pi : std::min(std::numbers::pi, cone.solid_angle());
  return color_weight(radiance) * area * angle * (both ? 2 : 1);
}

/// About the power that an emitter with a place sends to the target: how often it is chosen.
struct NearWeight {
  const std::optional<Target>& target;

  double operator()(const TriangleEmitter& e) const { return area(e); }
  double operator()(const RectangleEmitter& e) const { return area(e); }
  double operator()(const DiskEmitter& e) const { return area(e); }
  double operator()(const SphereEmitter& e) const {
    // A quarter of a ball's surface is what a far place sees of it.
    return e.radius > 0 ? area_weight(e.radiance, std::numbers::pi * e.radius * e.radius * (target ? 2 : 4),
                                      e.both_sides, Vec3d(e.center), target)
                        : 0;
  }
  double operator()(const PointEmitter& e) const {
    return e.falloff ? color_weight(e.intensity) * Cone(Vec3d(e.position), target).solid_angle() : 0;
  }
  double operator()(const SpotEmitter& e) const {
    return e.falloff ? color_weight(e.intensity) * cone_of(e, target).solid_angle() : 0;
  }
  double operator()(const DirectionalEmitter&) const { return 0; }
  double operator()(const EnvironmentEmitter&) const { return 0; }

 private:
  template <class Area>
  double area(const Area& e) const {
    const GlowingPlace middle = place_on(e, {0.25, 0.5});
    return area_weight(e.radiance, middle.area, e.both_sides, middle.position, target);
  }
};

bool is_distant(const Emitter& e) {
  return std::holds_alternative<DirectionalEmitter>(e) || std::holds_alternative<EnvironmentEmitter>(e);
}

/// Radiance times solid angle, averaged over the channels, of a distant emitter.
double distant_weight(const Emitter& emitter) {
  const double irradiance = distant_irradiance(emitter);
  if (const auto* e = std::get_if<EnvironmentEmitter>(&emitter))
    return e->map ? 4 * std::numbers::pi * e->map->mean_radiance() : 0;
  return irradiance;
}

/// A direction to a distant emitter, and its radiance divided by the density of the choice.
std::optional<Color> choose_distant(const Emitter& emitter, double half, const SquareSample& s,
                                    Vec3f& direction) {
  if (std::holds_alternative<DirectionalEmitter>(emitter)) {
    const auto sample = sample_emitter(emitter, {}, s);
    if (!sample) return std::nullopt;
    direction = sample->direction;
    return sample->radiance * (1 / sample->pdf);
  }
  // The density of the map may be 0 where it is not black.
  const EnvironmentMap& map = *std::get<EnvironmentEmitter>(emitter).map;
  if (map.samples() && half < 0.5)
    direction = map.sample(s).direction;
  else
    direction = Vec3f(around({0, 0, 1}, 2 * s.x, s.y));
  const double uniform = 1 / (4 * std::numbers::pi);
  const double pdf = map.samples() ? (map.pdf(direction) + uniform) / 2 : uniform;
  return map.radiance(direction) * static_cast<float>(1 / pdf);
}

double half_diagonal(const Box& box) { return length(Vec3d(box.hi) - Vec3d(box.lo)) / 2; }

}  // namespace

PhotonSource::PhotonSource(const World& world, const SceneLights& lights, const TextureSampler* textures,
                           const Casters& casters)
    : lights_(lights), textures_(textures) {
  const std::vector<Emitter>& emitters = lights.set().emitters();
  brings_.assign(emitters.size(), 0);
  if (casters.none()) return;
  if (!casters.unbounded) {
    // A little larger, so that rounded rays to its edge still count.
    target_ = Target{Vec3d(casters.bounds.center()), half_diagonal(casters.bounds) * 1.0001};
    far_ = target_->radius;
    if (!world.bounds.empty())
      far_ += length(Vec3d(world.bounds.center()) - target_->center) + half_diagonal(world.bounds);
  }
  brings_distant_ = target_.has_value();
  double sum = 0;
  for (std::uint32_t i = 0; i < emitters.size(); ++i) {
    double weight = std::visit(NearWeight{target_}, emitters[i]);
    if (is_distant(emitters[i]))
      weight =
          target_ ? distant_weight(emitters[i]) * std::numbers::pi * target_->radius * target_->radius : 0;
    if (!(weight > 0) || !std::isfinite(weight)) weight = 0;
    brings_[i] = weight > 0;
    sums_.push_back(sum += weight);
  }
}

std::optional<PhotonStart> PhotonSource::emit(double choice, const SquareSample& place,
                                              const SquareSample& direction) const {
  const double total = sums_.back();
  const auto found = std::upper_bound(sums_.begin(), sums_.end() - 1, choice * total);
  const auto number = static_cast<std::uint32_t>(found - sums_.begin());
  const double before = number == 0 ? 0 : sums_[number - 1], weight = sums_[number] - before;
  if (!(weight > 0)) return std::nullopt;
  const double rest = (choice * total - before) / weight;
  const Emitter& emitter = lights_.set().emitters()[number];
  std::optional<PhotonStart> start;
  GlowingPlace glowing;
  if (is_distant(emitter)) {
    Vec3f to;
    const auto light = choose_distant(emitter, rest, direction, to);
    if (!light) return std::nullopt;
    const Vec3d axis(to);
    Vec3d x, y;
    make_basis(axis, x, y);
    const double radius = target_->radius * std::sqrt(place.x), angle = 2 * std::numbers::pi * place.y;
    const Vec3d from = target_->center + x * (radius * portable::cos(angle)) +
                       y * (radius * portable::sin(angle)) + axis * far_;
    start =
        emit_from_point(Vec3f(from), -axis,
                        *light * static_cast<float>(std::numbers::pi * target_->radius * target_->radius));
    start->distant = true;
  } else if (const auto* e = std::get_if<PointEmitter>(&emitter)) {
    const Cone cone(Vec3d(e->position), target_);
    const Vec3d d = cone.direction(direction);
    start = emit_from_point(e->position, d,
                            e->intensity * (static_cast<float>(cone.solid_angle()) * e->profile(d)));
  } else if (const auto* spot = std::get_if<SpotEmitter>(&emitter)) {
    const Cone cone = cone_of(*spot, target_);
    const Vec3d d = cone.direction(direction);
    start = emit_from_point(spot->position, d, intensity(*spot, d) * static_cast<float>(cone.solid_angle()));
  } else {
    std::visit(
        [&](const auto& area) {
          if constexpr (requires { place_on(area, place); })
            start = emit_area(area, target_, rest, place, direction, glowing);
        },
        emitter);
  }
  if (!start) return std::nullopt;
  start->emitter = number;
  LightSample sample{};
  sample.emitter = number, sample.u = glowing.u, sample.v = glowing.v;
  start->power = start->power * lights_.texture_at(sample, textures_) * static_cast<float>(total / weight);
  if (!is_finite(start->power) || !(max_component(start->power) > 0)) return std::nullopt;
  return start;
}

}  // namespace oktett
