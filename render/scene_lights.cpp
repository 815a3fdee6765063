#include "render/scene_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <tuple>

#include "accel/hit_place.h"
#include "core/math.h"
#include "core/mesh_geometry.h"
#include "render/dielectric_stack.h"
#include "render/hit_object.h"
#include "render/light/sky.h"
#include "render/light_groups.h"
#include "render/shading_point.h"

namespace oktett {

// ---- Rectangles that meshes hold as two triangles.

/// Whether the edges are perpendicular, and the fourth corner is off by `rest` no more than a millionth of
/// them. The comparisons are false for NaN.
static bool is_rectangle(const Vec3d& u, const Vec3d& v, const Vec3d& rest) {
  const double skew = dot(u, v), size = std::min(length(u), length(v));
  return length(rest) < 1e-6 * size && skew * skew <= 1e-12 * dot(u, u) * dot(v, v);
}

std::optional<RectangleEmitter> rectangle_of(const TriangleEmitter& a, const TriangleEmitter& b) {
  if (!(a.radiance == b.radiance) || a.both_sides != b.both_sides) return std::nullopt;
  const Vec3f first[3] = {a.a, a.b, a.c}, second[3] = {b.a, b.b, b.c};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vec3f corner = first[i], next = first[(i + 1) % 3], last = first[(i + 2) % 3];
      const Vec3f after = second[(j + 1) % 3], before = second[(j + 2) % 3];
      const bool same_front = after == last && before == next;
      const bool turned = a.both_sides && after == next && before == last;
      if (!same_front && !turned) continue;
      const Vec3f u = next - corner, v = last - corner;
      const Vec3d rest = Vec3d(corner) + Vec3d(second[j]) - Vec3d(next) - Vec3d(last);
      if (is_rectangle(Vec3d(u), Vec3d(v), rest))
        return RectangleEmitter{corner, u, v, a.radiance, a.both_sides};
    }
  return std::nullopt;
}

// ---- The lights of a scene.

/// A white diffuse surface shows 1 / pi of the irradiance on it.
static constexpr auto kIrradiance = static_cast<float>(std::numbers::pi);

static Sky sky_of(const SkyLight& light) {
  return Sky({Vec3f(normalize(light.sun)), light.turbidity, light.ground});
}

DirectionalLight sun_of(const SkyLight& light) {
  const DirectionalEmitter sun = sky_of(light).sun();
  return {-Vec3d(sun.direction), sun.irradiance * light.color / kIrradiance,
          static_cast<double>(sun.angle) / kDegree};
}

AimedProfile profile_of(const PointLight& light) { return aim(light.profile, light.down, light.rotation); }

AimedProfile profile_of(const SpotLight& light) {
  return aim(light.profile, light.direction, light.rotation);
}

static Emitter emitter(const PointLight& light) {
  return PointEmitter{Vec3f(light.position), light.color * kIrradiance, light.falloff, profile_of(light),
                      light.fade};
}

static Emitter emitter(const SpotLight& light) {
  if (light.profile != nullptr)
    return PointEmitter{Vec3f(light.position), light.color * kIrradiance, light.falloff, profile_of(light),
                        light.fade};
  const auto cos_outer = static_cast<float>(portable::cos(light.outer_angle * kDegree));
  const auto cos_inner = static_cast<float>(portable::cos(light.inner_angle * kDegree));
  // A sharp edge is one that fades over the least step of the cosine.
  return SpotEmitter{.position = Vec3f(light.position),
                     .axis = Vec3f(normalize(light.direction)),
                     .intensity = light.color * kIrradiance,
                     .cos_inner = std::max(cos_inner, cos_outer + 0x1p-23f),
                     .cos_outer = cos_outer,
                     .falloff = light.falloff,
                     .fade = light.fade,
                     .tightness = light.tightness};
}

static Emitter emitter(const DirectionalLight& light) {
  return DirectionalEmitter{Vec3f(normalize(-light.direction)), light.color * kIrradiance,
                            static_cast<float>(light.angle * kDegree)};
}

static Emitter emitter(const EnvironmentLight& light) {
  EnvironmentPicture picture = *light.picture;
  for (Color& pixel : picture.pixels) pixel = pixel * light.color;
  EnvironmentOptions options;
  options.rotation = light.rotation * kDegree;
  options.compensate = true;
  return EnvironmentEmitter{std::make_shared<const EnvironmentMap>(std::move(picture), options)};
}

static Emitter emitter(const SkyLight& light) {
  return emitter(
      EnvironmentLight{std::make_shared<const EnvironmentPicture>(sky_of(light).picture()), 0, light.color});
}

static bool has_place(const Light& light) {
  return std::holds_alternative<PointLight>(light) || std::holds_alternative<SpotLight>(light);
}

/// Turns glowing surfaces into emitters.
class EmitterCollector {
 public:
  /// Of surfaces that rays of all of `kinds` meet.
  EmitterCollector(const World& world, const LightGroups& groups, bool traces_paths,
                   std::span<const RayKind> kinds, SceneLights& lights, std::vector<Emitter>& emitters,
                   std::vector<std::uint8_t>& lists)
      : world_(world),
        groups_(groups),
        traces_paths_(traces_paths),
        kinds_(kinds),
        lights_(lights),
        emitters_(emitters),
        lists_(lists) {}

  void collect() {
    if (std::ranges::none_of(world_.materials, can_sample)) return;
    std::vector<PlacedGeometry> placed;
    visit_placed_geometries(*world_.accel, [&](const PlacedGeometry& p) {
      if (may_glow(p)) placed.push_back(p);
    });
    for (const RayKind kind : kinds_) leave_hidden_out(seen_by(world_, kind), placed);
    // In an order that does not depend on how the structure was built.
    std::sort(placed.begin(), placed.end(), [](const PlacedGeometry& a, const PlacedGeometry& b) {
      return std::tie(a.instance, a.first_item) < std::tie(b.instance, b.first_item);
    });
    std::vector<Geometry> surfaces;
    const bool alone = traces_paths_ && shadows_differ(world_);
    for (const PlacedGeometry& p : placed) {
      const std::size_t before = emitters_.size();
      std::visit([&](const auto& shape) { add(p, shape); }, p.geometry->shape);
      if (!alone || emitters_.size() == before) continue;
      surfaces.push_back({p.geometry->shape, p.to_world, kNoId});
      lights_.surface_keys_.push_back({p.instance, p.first_item, kNoId});
    }
    if (!surfaces.empty()) lights_.emitter_surfaces_ = build_accel(std::move(surfaces));
  }

 private:
  static bool can_sample(const Material& m) {
    // Where another solid hides the surface it gives no light. Only a ray that meets the surface can tell.
    const bool may_be_hidden = encloses(m) && m.priority != kNoPriority;
    return glows(m) && m.opacity == 1 && m.opacity_texture == kNoId && m.tint_opacity_texture == kNoId &&
           !may_be_hidden;
  }

  /// Leaves out what `accel`, the world as rays of a kind see it, does not show.
  void leave_hidden_out(const Accel& accel, std::vector<PlacedGeometry>& placed) const {
    if (&accel == world_.accel.get()) return;
    std::set<std::pair<std::uint32_t, std::uint32_t>> shown;
    visit_placed_geometries(accel, [&](const PlacedGeometry& p) { shown.emplace(p.instance, p.first_item); });
    std::erase_if(placed, [&](const PlacedGeometry& p) {
      return !shown.contains({p.instance, p.first_item});
    });
  }

  bool may_glow(const PlacedGeometry& p) const {
    const auto sampled = [&](std::uint32_t slot) {
      return can_sample(world_.materials[material_index(world_, p.user, slot)]);
    };
    if (sampled(0)) return true;
    if (!std::holds_alternative<MeshGeometry>(p.geometry->shape) || p.user >= world_.objects.size())
      return false;
    for (std::uint32_t slot = 1; slot < world_.objects[p.user].slots.size(); ++slot)
      if (sampled(slot)) return true;
    return false;
  }

  /// The material of a primitive if it can be sampled.
  const Material* material(const PlacedGeometry& p, std::uint32_t slot = 0) const {
    const Material& m = world_.materials[material_index(world_, p.user, slot)];
    return can_sample(m) ? &m : nullptr;
  }

  std::uint32_t add_emitter(const PlacedGeometry& p, std::uint32_t primitive, const Material& m,
                            Emitter emitter) {
    const auto number = static_cast<std::uint32_t>(emitters_.size());
    lights_.keys_.push_back({p.instance, p.first_item + primitive, number});
    const auto material = static_cast<std::uint32_t>(&m - world_.materials.data());
    if (groups_.any()) lights_.groups_.push_back(groups_.material(material));
    if (world_.has_light_lists)
      lists_.push_back(
          light_list_number(p.user < world_.objects.size() ? world_.objects[p.user].light_list : kNoId));
    emitters_.push_back(std::move(emitter));
    return number;
  }

  void add(const PlacedGeometry& p, const MeshGeometry& shape) {
    const TriangleMesh& mesh = *shape.mesh;
    // A mirror reverses the winding of the corners, but the front stays the front.
    const bool mirrored = p.to_world.determinant() < 0;
    // The last emitter and its material, if it is a triangle that may be half of a rectangle.
    std::optional<TriangleEmitter> half;
    const Material* of_half = nullptr;
    for (std::uint32_t k = 0; k < mesh.triangle_count(); ++k) {
      const Material* m = material(p, mesh.material_slots.empty() ? 0u : mesh.material_slots[k]);
      if (m == nullptr) continue;
      const auto placed = [&](std::size_t i) { return Vec3f(p.to_world.point(corner(mesh, k, i))); };
      TriangleEmitter e{placed(0), placed(1), placed(2), m->emission, m->emits_behind};
      // Where the texture lies is found by the weights of the corners, so their order must stay.
      if (mirrored && !m->emits_behind) {
        if (m->emission_texture != kNoId) continue;
        std::swap(e.b, e.c);
      }
      const bool textured = m->emission_texture != kNoId;
      if (half && m == of_half && !textured)
        if (const auto whole = rectangle_of(*half, e)) {
          emitters_.back() = *whole;
          const std::uint32_t number = lights_.keys_.back().emitter;
          lights_.keys_.push_back({p.instance, p.first_item + k, number});
          half.reset();
          continue;
        }
      const std::uint32_t number = add_emitter(p, k, *m, e);
      of_half = m, half = textured ? std::nullopt : std::optional(e);
      if (textured) lights_.textured_.push_back({number, m->emission_texture, k, &mesh});
    }
  }

  void add(const PlacedGeometry& p, const SpheresShape& shape) {
    const Material* m = material(p);
    const double scale = p.to_world.uniform_scale();
    if (m == nullptr || m->emission_texture != kNoId || scale == 0) return;
    for (std::uint32_t k = 0; k < shape.spheres.size(); ++k) {
      const SphereShape& s = shape.spheres[k];
      add_emitter(
          p, k, *m,
          SphereEmitter{Vec3f(p.to_world.point(s.center)), static_cast<float>(s.radius * std::abs(scale)),
                        m->emission, m->emits_behind});
    }
  }

  void add(const PlacedGeometry& p, const DiskShape& shape) {
    const Material* m = material(p);
    const double scale = p.to_world.uniform_scale();
    if (m == nullptr || m->emission_texture != kNoId || scale == 0 || shape.inner_radius > 0) return;
    const Vec3d normal = p.to_world.inverse().normal_by_inverse(shape.normal);
    add_emitter(
        p, 0, *m,
        DiskEmitter{Vec3f(p.to_world.point(shape.center)), Vec3f(normalize(normal)),
                    static_cast<float>(shape.radius * std::abs(scale)), m->emission, m->emits_behind});
  }

  void add(const PlacedGeometry& p, const PolygonShape& shape) {
    const Material* m = material(p);
    if (m == nullptr || m->emission_texture != kNoId || shape.vertices.size() != 4 || !shape.holes.empty())
      return;
    const auto corner = [&](std::size_t i) { return p.to_world.point(shape.vertices[i]); };
    const Vec3d u = corner(1) - corner(0), v = corner(3) - corner(0), rest = corner(2) - corner(1) - v;
    const double size = std::max(length(u), length(v));
    if (length(rest) > 1e-6 * size || std::abs(dot(u, v)) > 1e-6 * length(u) * length(v)) return;
    const bool mirrored = p.to_world.determinant() < 0;
    add_emitter(p, 0, *m,
                RectangleEmitter{Vec3f(corner(0)), Vec3f(mirrored ? v : u), Vec3f(mirrored ? u : v),
                                 m->emission, m->emits_behind});
  }

  /// Other shapes are not sampled.
  template <class Shape>
  void add(const PlacedGeometry&, const Shape&) {}

  const World& world_;
  const LightGroups& groups_;
  bool traces_paths_;
  std::span<const RayKind> kinds_;
  SceneLights& lights_;
  std::vector<Emitter>& emitters_;
  std::vector<std::uint8_t>& lists_;
};

static bool is_environment(const Light& light) {
  return std::holds_alternative<EnvironmentLight>(light) || std::holds_alternative<SkyLight>(light);
}

SceneLights::SceneLights(const Scene& scene, const World& world, const SceneLights* like)
    : texture_list_(scene.textures) {
  std::vector<Emitter> emitters;
  std::vector<std::uint8_t> lists;
  const LightGroups groups = light_groups(scene);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    if (like != nullptr && is_environment(light))
      emitters.push_back(EnvironmentEmitter{like->environments_[environments_.size()]});
    else
      std::visit([&](const auto& l) { emitters.push_back(emitter(l)); }, light);
    if (const auto* environment = std::get_if<EnvironmentEmitter>(&emitters.back()))
      environments_.push_back(environment->map);
    if (const auto* sky = std::get_if<SkyLight>(&light)) emitters.push_back(emitter(sun_of(*sky)));
    if (groups.any()) groups_.resize(emitters.size(), groups.of_light[i]);
    if (world.has_light_lists) lists.resize(emitters.size(), light_list_number(list_of_light(scene, i)));
    const auto* directional = std::get_if<DirectionalLight>(&light);
    const bool point = directional != nullptr ? directional->angle == 0 : has_place(light);
    has_environment_ |= !point;
  }
  // There may be millions of surfaces, so they are listed only for those who ask.
  const IntegratorSettings& asking = scene.integrator;
  const bool whitted = traits(asking.kind).light_from_points && asking.light_samples > 0;
  // A path samples only what each of its bounces may meet; others find it by chance. Whitted's model lights
  // diffuse surfaces.
  std::span<const RayKind> kinds = kBounceKinds;
  if (whitted) kinds = kinds.first(1);
  static_assert(kBounceKinds[0] == RayKind::diffuse);
  const bool path = traits(asking.kind).traces_paths;
  if (whitted || path) EmitterCollector(world, groups, path, kinds, *this, emitters, lists).collect();
  set_ = LightSet(std::move(emitters), std::move(lists));
}

std::optional<std::uint8_t> SceneLights::environment_group() const {
  const std::vector<std::uint32_t>& visible = set_.visible();
  const std::uint8_t first = visible.empty() ? std::uint8_t{0} : group(visible.front());
  for (const std::uint32_t emitter : visible)
    if (group(emitter) != first) return std::nullopt;
  return first;
}

std::uint32_t SceneLights::emitter_at(const Hit& hit) const {
  const auto found =
      std::lower_bound(keys_.begin(), keys_.end(), hit, [](const EmitterKey& key, const Hit& h) {
        return std::tie(key.instance, key.item) < std::tie(h.instance, h.item);
      });
  if (found == keys_.end() || found->instance != hit.instance || found->item != hit.item) return kNoId;
  return found->emitter;
}

Hit SceneLights::world_hit(const Hit& hit) const {
  const SurfaceInteraction names = identify(*emitter_surfaces_, hit);
  const EmitterKey& key = surface_keys_[names.geometry];
  Hit there = hit;
  there.instance = key.instance, there.item = key.item + names.primitive;
  return there;
}

Color SceneLights::texture_at(const LightSample& sample, const TextureSampler* textures) const {
  if (textured_.empty()) return {1, 1, 1};
  const auto found =
      std::lower_bound(textured_.begin(), textured_.end(), sample.emitter,
                       [](const TexturedEmitter& e, std::uint32_t number) { return e.emitter < number; });
  if (found == textured_.end() || found->emitter != sample.emitter) return {1, 1, 1};
  const TriangleMesh& mesh = *found->mesh;
  const std::array<Vec2f, 3> uv = corner_uvs(mesh, found->triangle);
  const float weight[3] = {1 - sample.u - sample.v, sample.u, sample.v};
  TexturePlace at;
  const std::array<Vec2f, 3> second = corner_uvs(mesh, found->triangle, 1);
  at.on_mesh = {&mesh, found->triangle, sample.u, sample.v};
  for (std::size_t k = 0; k < 3; ++k) {
    at.second.uv.x += second[k].x * weight[k], at.second.uv.y += second[k].y * weight[k];
    at.uv.x += uv[k].x * weight[k], at.uv.y += uv[k].y * weight[k];
    at.position += corner(mesh, found->triangle, k) * double{weight[k]};
  }
  return texture_color({texture_list_, textures}, found->texture, at);
}

}  // namespace oktett
