#include "render/shading_point.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "accel/accel.h"
#include "core/color.h"
#include "core/math.h"
#include "core/mesh_geometry.h"
#include "render/bsdf/metals.h"
#include "render/bsdf/optics.h"
#include "render/bsdf/principled_lobes.h"
#include "render/hit_object.h"
#include "render/shading_lanes.h"

namespace oktett {

/// Whether surfaces of the material have facets that are wider along a direction of uv.
static bool is_stretched(const Material& m) {
  return m.principled && m.principled->parameters.anisotropy > 0;
}

namespace {

/// Changes of uv across a pixel.
struct Footprint {
  Vec2f dx, dy;
};

/// The footprint from vectors in the tangent plane, by what u and v add to the point. Where one of them adds
/// nothing, as on a wall of a height field, by the other alone.
Footprint footprint(const SurfaceInteraction& s, const Vec3f& x, const Vec3f& y, float scale) {
  const Vec3f &du = s.tangent, &dv = s.bitangent;
  const float uu = dot(du, du), uv = dot(du, dv), vv = dot(dv, dv), det = uu * vv - uv * uv;
  const auto along = [&](const Vec3f& w) -> Vec2f {
    const float wu = dot(w, du) * scale, wv = dot(w, dv) * scale;
    if (det > 0) return {(wu * vv - wv * uv) / det, (wv * uu - wu * uv) / det};
    return {uu > 0 ? wu / uu : 0, vv > 0 ? wv / vv : 0};
  };
  const Footprint f{along(x), along(y)};
  const bool known =
      std::isfinite(f.dx.x) && std::isfinite(f.dx.y) && std::isfinite(f.dy.x) && std::isfinite(f.dy.y);
  return known ? f : Footprint{};
}

/// The neighbours of a camera ray are known. Other rays count as cones with the angle of a pixel.
void pixel_vectors(const RenderContext& c, const Ray& ray, const Hit& hit, const SurfaceInteraction& s,
                   const RayHistory& history, Vec3f& x, Vec3f& y) {
  if (history.from_camera && history.distance == 0) {
    pixel_footprint(c.camera, ray, s.position, s.geometric_normal, x, y);
  } else {
    const bool parallel = c.camera.projection == Projection::orthographic;
    const auto width = static_cast<float>(c.camera.pixel_size * (parallel ? 1 : history.distance + hit.t));
    make_basis(s.geometric_normal, x, y);
    x *= width, y *= width;
  }
}

/// Texture coordinates of the second layer, and what they add to the point.
SurfaceInteraction by_second_uvs(const RenderContext& context, const SurfaceInteraction& s, const Hit& hit) {
  const MeshPoint at = mesh_point(*context.world->accel, hit);
  SurfaceInteraction second = s;
  if (at.mesh == nullptr) return second;
  const std::array<Vec2f, 3> uv = corner_uvs(*at.mesh, at.triangle, 1);
  const float weights[3] = {1 - hit.u - hit.v, hit.u, hit.v};
  second.uv = {0, 0};
  const Affine to_world = object_transform(*context.world->accel, hit);
  Vec3f corners[3];
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    second.uv.x += uv[i].x * weights[k], second.uv.y += uv[i].y * weights[k];
    const std::uint32_t vertex = at.mesh->indices[3 * std::size_t{at.triangle} + i];
    corners[k] = Vec3f(to_world.vector(Vec3d(at.mesh->positions[vertex])));
  }
  set_uv_tangents(uv, corners, second.tangent, second.bitangent);
  return second;
}

Color textured(const RenderContext& c, const Color& color, std::uint32_t texture, const TexturePlace& place) {
  return texture == kNoId ? color : color * texture_color(c, texture, place);
}

/// The value of a number where its texture has that value. A NaN becomes the least value.
float in_range(float value, const Range& range) {
  const auto lo = static_cast<float>(range.lo);
  return value > lo ? std::min(value, static_cast<float>(range.hi)) : lo;
}

/// A number times its texture, within its range.
float textured(const RenderContext& c, float value, std::uint32_t texture, const Range& range,
               const TexturePlace& place) {
  return texture == kNoId ? value : in_range(value * texture_value(c, texture, place), range);
}

float opacity_at(const RenderContext& c, const Material& m, const TexturePlace& place) {
  if (!m.surface) return 0;
  const float opacity = textured(c, m.opacity, m.opacity_texture, kUnitInterval, place);
  return textured(c, opacity, m.tint_opacity_texture, kUnitInterval, place);
}

/// Of diffuse light, and of light that passes.
Color color_at(const RenderContext& c, const Material& m, const TexturePlace& place) {
  return textured(c, textured(c, m.color, m.color_texture, place), m.tint_texture, place);
}

/// Of light that is mirrored, if it is not that of highlights.
std::optional<Color> reflection_color_at(const RenderContext& c, const Material& m,
                                         const TexturePlace& place) {
  if (!m.reflection_color) return std::nullopt;
  return textured(c, *m.reflection_color, m.reflection_color_texture, place);
}

/// Of light that passes, if it is not the colour.
std::optional<Color> filter_at(const RenderContext& c, const Material& m, const TexturePlace& place) {
  if (!m.filter) return std::nullopt;
  return textured(c, *m.filter, m.filter_texture, place);
}

PrincipledParameters principled_at(const RenderContext& c, const PrincipledMaterial& m, const Color& color,
                                   const TexturePlace& place) {
  PrincipledParameters at = m.parameters;
  at.base_color = color;
  for (const PrincipledNumber& number : kPrincipledNumbers)
    at.*number.value = textured(c, at.*number.value, m.*number.texture, number.range, place);
  for (const PrincipledColor& tint : kPrincipledColors)
    at.*tint.value = textured(c, at.*tint.value, m.*tint.texture, place);
  if (at.conductor) {
    at.conductor->eta = textured(c, at.conductor->eta, m.eta_texture, place);
    at.conductor->k = textured(c, at.conductor->k, m.k_texture, place);
  }
  return at;
}

PhongValues phong_values(const RenderContext& c, const Material& m, const TexturePlace& place) {
  PhongValues values{m.ambient,
                     m.diffuse,
                     m.specular,
                     m.phong,
                     m.reflection,
                     m.transparency,
                     m.reflection_grazing,
                     m.brilliance,
                     m.specular_blinn,
                     m.blinn,
                     m.grain,
                     m.diffuse_back,
                     m.film,
                     m.film_thickness};
  float* const at[] = {&values.ambient,
                       &values.diffuse,
                       &values.specular,
                       &values.phong,
                       &values.reflection,
                       &values.transparency,
                       &values.reflection_grazing,
                       &values.brilliance,
                       &values.specular_blinn,
                       &values.blinn,
                       &values.grain,
                       &values.diffuse_back,
                       &values.film,
                       &values.film_thickness};
  for (std::size_t i = 0; i < std::size(kPhongNumbers); ++i)
    *at[i] = textured(c, *at[i], m.*kPhongNumbers[i].texture, kPhongNumbers[i].range, place);
  return values;
}

/// Whether the picture shows the principled parameters of a material, or what resembles them.
bool shows_principled(const RenderContext& c, const Material& m) {
  return m.principled && (traits(c.settings.kind).traces_paths || m.principled->resembled);
}

/// Sets what the picture shows of the principled parameters.
void set_principled(const RenderContext& c, const TexturePlace& place, ShadingPoint& p) {
  const Material& m = *p.material;
  PrincipledParameters at = principled_at(c, *m.principled, p.color, place);
  p.ior = at.ior;
  if (traits(c.settings.kind).traces_paths) {
    p.principled = at;
    return;
  }
  // What shows no indices of refraction shows the colour that they give head-on.
  if (at.conductor && (m.principled->eta_texture != kNoId || m.principled->k_texture != kNoId))
    at.base_color = head_on_color(*at.conductor);
  p.values = resembling_values(at);
  p.specular_color = resembling_specular_color(at);
}

/// The weight of light that passes at a place.
float transparency_at(const RenderContext& c, const Material& m, const TexturePlace& place) {
  if (!shows_principled(c, m))
    return textured(c, m.transparency, m.transparency_texture, kUnitInterval, place);
  const PrincipledMaterial& p = *m.principled;
  return glass_weight(textured(c, p.parameters.metallic, p.metallic_texture, kUnitInterval, place),
                      textured(c, p.parameters.transmission, p.transmission_texture, kUnitInterval, place));
}

/// `bent`, of any length, as a unit normal, or `n` if it is none.
Vec3f unit_normal(const Vec3f& bent, const Vec3f& n) {
  return is_finite(bent) && dot(bent, bent) > 0 ? normalize(bent) : n;
}

/// The normal of the surface displaced by a height map along `n` (Blinn 1978).
Vec3f bumped(const RenderContext& c, const Material& m, const SurfaceInteraction& s, const Vec3f& n,
             const UvPlace& place) {
  const Vec3f across = cross(s.tangent, s.bitangent);
  const PatternTexture* const pattern = pattern_in(c.texture_list, m.bump_texture);
  if ((c.textures == nullptr && pattern == nullptr) || !(dot(across, across) > 0)) return n;
  const auto step = [](float x, float y) { return std::max(0.5f * (std::abs(x) + std::abs(y)), 0x1p-11f); };
  const float du = step(place.dx.x, place.dy.x), dv = step(place.dx.y, place.dy.y);
  const auto height = [&](float u, float v) {
    const Vec2f uv{s.uv.x + u, s.uv.y + v};
    if (pattern == nullptr) return m.bump_scale * c.textures->value(m.bump_texture, uv, place.dx, place.dy);
    TexturePlace there;
    there.uv = uv;
    return m.bump_scale * texture_color(c, m.bump_texture, there).x;
  };
  const float here = height(0, 0), by_u = (height(du, 0) - here) / du, by_v = (height(0, dv) - here) / dv;
  // cross(dp/du + by_u n, dp/dv + by_v n) without the square of n, on the side of n.
  const float area = dot(across, n);
  const Vec3f tilt = cross(s.bitangent, n) * by_u + cross(n, s.tangent) * by_v;
  return unit_normal(n * std::abs(area) - (area < 0 ? -tilt : tilt), n);
}

/// The same for heights that are given in space and have the gradient `slope`: the surface where F = 0
/// becomes that where F = height |grad F|, so its normal loses the part of the gradient that runs along the
/// surface (Perlin 1985). All in the object's space, which `to_world` leads out of. `along_too`: it loses all
/// of the gradient, as in POV-Ray.
Vec3f bumped_by_slope(const Vec3d& slope, const Affine& to_world, const Affine& to_object, const Vec3f& n,
                      bool along_too = false) {
  const Vec3d own = normalize(to_world.normal_by_inverse(Vec3d(n)));
  return unit_normal(Vec3f(normalize(to_object.normal_by_inverse(
                         own - (along_too ? slope : slope - own * dot(slope, own))))),
                     n);
}

/// The axes of a normal map on a surface; of any length.
struct MapAxes {
  Vec3f first, second;
};

/// What the coordinates in the image add to the point, where uv do so as in `s`.
MapAxes image_axes(const RenderContext& c, std::uint32_t texture, const SurfaceInteraction& s) {
  if (texture >= c.texture_list.size()) return {s.tangent, s.bitangent};
  const Texture& t = c.texture_list[texture];
  const Vec3f by_u = t.scale.x < 0 ? -s.tangent : s.tangent,
              by_v = t.scale.y < 0 ? -s.bitangent : s.bitangent;
  if (t.rotation == 0) return {by_u, by_v};
  const auto cosine = static_cast<float>(portable::cos(double{t.rotation})),
             sine = static_cast<float>(portable::sin(double{t.rotation}));
  const float wide = std::abs(t.scale.x), high = std::abs(t.scale.y);
  return {by_u * (cosine * high) - by_v * (sine * wide), by_u * (sine * high) + by_v * (cosine * wide)};
}

/// The tangents of the mesh that was hit; zeros if it has none there.
MapAxes tangent_axes(const RenderContext& c, const Hit& hit, const Vec3f& n) {
  const MeshPoint at = mesh_point(*c.world->accel, hit);
  if (at.mesh == nullptr || at.mesh->tangents.empty()) return {};
  const float weights[3] = {1 - hit.u - hit.v, hit.u, hit.v};
  Vec3f tangent{0, 0, 0};
  float side = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t index = at.mesh->normal_indices[3 * std::size_t{at.triangle} + k];
    if (index == kNoId) return {};
    const std::array<float, 4>& own = at.mesh->tangents[index];
    tangent += Vec3f{own[0], own[1], own[2]} * weights[k];
    side += own[3] * weights[k];
  }
  const Affine to_world = object_transform(*c.world->accel, hit);
  const Vec3f first = Vec3f(to_world.vector(Vec3d(tangent)));
  const bool is_left = (side < 0) == (to_world.determinant() < 0);
  return {first, is_left ? cross(n, first) : cross(first, n)};
}

/// The unit vectors of tangent space about a normal: the first runs along the mesh's tangents, else along the
/// image's own; the second to the side of the image's second one. Nothing where uv say nothing.
std::optional<MapAxes> unit_axes(const RenderContext& c, std::uint32_t texture, const SurfaceInteraction& s,
                                 const Hit& hit, const Vec3f& n) {
  MapAxes axes = tangent_axes(c, hit, n);
  Vec3f flat = axes.first - n * dot(axes.first, n);
  if (!(dot(flat, flat) > 0)) {
    axes = image_axes(c, texture, s);
    flat = axes.first - n * dot(axes.first, n);
  }
  if (!(dot(flat, flat) > 0)) return std::nullopt;
  const Vec3f t = normalize(flat), left = cross(n, t);
  return MapAxes{t, dot(left, axes.second) < 0 ? -left : left};
}

/// The normal from a tangent-space normal map.
Vec3f mapped(const RenderContext& c, std::uint32_t texture, float scale, const SurfaceInteraction& s,
             const Hit& hit, const Vec3f& n, const UvPlace& place) {
  if (c.textures == nullptr) return n;
  const std::optional<MapAxes> axes = unit_axes(c, texture, s, hit, n);
  if (!axes) return n;
  const auto& [t, b] = *axes;
  const Vec3f texel = c.textures->normal(texture, s.uv, place.dx, place.dy) * 2 - Vec3f{1, 1, 1};
  return unit_normal(t * (texel.x * scale) + b * (texel.y * scale) + n * texel.z, n);
}

/// The gradient along a triangle of the number that a texture takes from an attribute, without its gain.
Vec3d attribute_slope(const Texture& t, const MeshPoint& place) {
  const MeshAttribute* const attribute =
      place.mesh == nullptr ? nullptr : find_attribute(*place.mesh, t.attribute);
  if (attribute == nullptr || attribute->domain == AttributeDomain::face) return {};
  const TriangleMesh& mesh = *place.mesh;
  const std::uint32_t triangle = place.triangle;
  const auto height = [&](float u, float v) -> double {
    return number_of(attribute_at({&mesh, triangle, u, v}, *attribute), t.channel);
  };
  const Vec3d a = corner(mesh, triangle, 0), b = corner(mesh, triangle, 1) - a,
              c = corner(mesh, triangle, 2) - a;
  const Vec3d normal = cross(b, c);
  const double square = dot(normal, normal), h = height(0, 0);
  if (!(square > 0)) return {};
  // Its products with b and c are the differences of the heights.
  return (cross(c, normal) * (height(1, 0) - h) + cross(normal, b) * (height(0, 1) - h)) * (1 / square);
}

/// What the textures of one of World::materials ask.
const TextureNeeds& needs_of(const RenderContext& context, const Material& m) {
  return context.texture_needs[static_cast<std::size_t>(&m - context.world->materials.data())];
}

/// Whether its textures ask more of a hit than hits in lanes know, which is enough for patterns in space.
bool asks_frame(const RenderContext& context, const Material& m) {
  const TextureNeeds& needs = needs_of(context, m);
  return needs.uv || needs.mesh;
}

/// Where on its mesh, or on the points and lines of one, a hit lies.
MeshPoint place_on_mesh(const RenderContext& context, const SurfaceInteraction& s, const Hit& hit) {
  const World& world = *context.world;
  const StrokeParts* const strokes =
      s.user < world.objects.size() ? world.objects[s.user].strokes.get() : nullptr;
  if (strokes == nullptr) return mesh_point(*world.accel, hit);
  return strokes->at(s, object_transform(*world.accel, hit).inverse().point(Vec3d(s.position)));
}

/// What the textures of a material ask of a hit.
class TexturedHit {
 public:
  /// `direction`: of the ray, of any length.
  TexturedHit(const RenderContext& context, const Material& m, const SurfaceInteraction& s, const Hit& hit,
              const Vec3f& direction)
      : context_(context), m_(m), s_(s), hit_(hit) {
    place.uv = s.uv;
    place.to_viewer = normalize(-Vec3d(direction));
    set_normal(s.shading_normal);
    const TextureNeeds& needs = needs_of(context, m);
    if (needs.second_uvs) {
      second_ = by_second_uvs(context, s, hit);
      place.second.uv = second_->uv;
    }
    if (needs.mesh) place.on_mesh = place_on_mesh(context, s, hit);
    if (!needs.position && attribute_in(context.texture_list, m.bump_texture) == nullptr) return;
    to_world_ = object_transform(*context.world->accel, hit);
    to_object_ = to_world_.inverse();
    place.position = to_object_.point(Vec3d(s.position));
  }

  /// Sets what patterns know of the normal.
  void set_normal(const Vec3f& normal) {
    place.normal = Vec3d(normal);
    if (dot(Vec3d(s_.geometric_normal), place.to_viewer) < 0) place.normal = -place.normal;
  }

  /// Sets how the places change across a pixel.
  void set_footprints(const Vec3f& x, const Vec3f& y) {
    const auto set = [&](const SurfaceInteraction& s, UvPlace& at) {
      const Footprint f = footprint(s, x, y, context_.footprint_scale);
      at.dx = f.dx, at.dy = f.dy;
    };
    set(s_, place);
    if (second_) set(*second_, place.second);
  }

  Vec3f shading_normal() const {
    Vec3f n = s_.shading_normal;
    const PatternTexture* const pattern = pattern_in(context_.texture_list, m_.bump_texture);
    if (pattern != nullptr && !pattern->by_uv) {
      double scale = double{m_.bump_scale} * double{context_.texture_list[m_.bump_texture].gain};
      // In POV-Ray the normal on the side of the viewer is bent.
      const bool as_povray = pattern->turbulence.generator != NoiseGenerator::own;
      if (as_povray && dot(Vec3d(s_.geometric_normal), place.to_viewer) < 0) scale = -scale;
      const Textures textures{context_.texture_list, context_.textures};
      const NestedTextures nested(textures, place, 1);
      n = bumped_by_slope(pattern_slope(*pattern, place.position, &nested) * scale, to_world_, to_object_, n,
                          as_povray);
    } else if (const Texture* attribute = attribute_in(context_.texture_list, m_.bump_texture)) {
      const double scale = double{m_.bump_scale} * double{attribute->gain};
      n = bumped_by_slope(attribute_slope(*attribute, place.on_mesh) * scale, to_world_, to_object_, n);
    } else if (m_.bump_texture != kNoId) {
      n = bumped(context_, m_, surface_of(m_.bump_texture), n, place_of(m_.bump_texture));
    }
    return mapped_by(m_.normal_texture, m_.normal_scale, n);
  }

  /// That of the coat, if it is not that of the surface.
  std::optional<Vec3f> coat_normal() const {
    if (!m_.principled) return std::nullopt;
    const PrincipledMaterial& p = *m_.principled;
    if (p.coat_normal_texture == kNoId && !p.even_coat) return std::nullopt;
    return mapped_by(p.coat_normal_texture, p.coat_normal_scale, s_.shading_normal);
  }

  /// The direction along which facets are wider, in space.
  std::optional<Vec3f> stretch() const {
    if (!is_stretched(m_)) return std::nullopt;
    const PrincipledMaterial& p = *m_.principled;
    const std::uint32_t texture = p.anisotropy_direction_texture;
    const SurfaceInteraction& s = surface_of(texture);
    const std::optional<MapAxes> axes = unit_axes(context_, texture, s, hit_, s_.shading_normal);
    if (!axes) return std::nullopt;
    float x = 1, y = 0;
    if (texture != kNoId && context_.textures != nullptr) {
      const UvPlace& at = place_of(texture);
      const Vec3f texel = context_.textures->normal(texture, s.uv, at.dx, at.dy);
      if (texel.x != 0.5f || texel.y != 0.5f) x = 2 * texel.x - 1, y = 2 * texel.y - 1;
    }
    const double angle = double{p.anisotropy_rotation} * kDegree;
    const auto cosine = static_cast<float>(portable::cos(angle)),
               sine = static_cast<float>(portable::sin(angle));
    return axes->first * (cosine * x - sine * y) + axes->second * (sine * x + cosine * y);
  }

  TexturePlace place;

 private:
  Vec3f mapped_by(std::uint32_t texture, float scale, const Vec3f& n) const {
    if (texture == kNoId) return n;
    return mapped(context_, texture, scale, surface_of(texture), hit_, n, place_of(texture));
  }
  const UvPlace& place_of(std::uint32_t texture) const {
    return uv_place(context_.texture_list, texture, place);
  }
  /// The surface with the uv of a texture's layer.
  const SurfaceInteraction& surface_of(std::uint32_t texture) const {
    return second_ && &place_of(texture) == &place.second ? *second_ : s_;
  }

  const RenderContext& context_;
  const Material& m_;
  const SurfaceInteraction& s_;
  const Hit& hit_;
  std::optional<SurfaceInteraction> second_;
  Affine to_world_, to_object_;
};

/// Where the textures of a material are looked up at a hit whose footprint is not known.
TexturePlace texture_place(const RenderContext& context, const Material& m, const Ray& ray, const Hit& hit) {
  if (!needs_of(context, m).any) return {};
  return TexturedHit(context, m, surface_interaction(*context.world->accel, ray, hit), hit, ray.direction)
      .place;
}

using OneFloat = Simd<float, 1, ScalarIsa>;

/// Sets `front`, `ng` and `ns`.
void face_ray(ShadingPoint& p, const Vec3f& shading_normal) {
  Vec3<OneFloat> ng, ns;
  p.front = none(face_ray(broadcast<OneFloat>(p.direction), broadcast<OneFloat>(p.surface.geometric_normal),
                          broadcast<OneFloat>(shading_normal), ng, ns));
  p.ng = only_lane(ng), p.ns = only_lane(ns);
}

/// The weight of the mirrored ray by the angle at which the ray arrives.
float varying_reflection(const ShadingPoint& p) {
  const double cosine = std::clamp(-static_cast<double>(dot(p.direction, p.ns)), 0.0, 1.0);
  const double falloff = p.material->reflection_falloff, ior = p.ior;
  const double part =
      falloff > 0 ? portable::pow(1 - cosine, falloff) : fresnel(cosine, p.front ? ior : 1 / ior);
  return p.values.reflection + (p.values.reflection_grazing - p.values.reflection) * static_cast<float>(part);
}

/// What a hit knows of the frame of its normal, beyond that.
struct HitFrame {
  std::optional<Vec3f> coat_normal;  ///< if it is not the normal of the surface
  std::optional<Vec3f> stretch;      ///< the direction along which facets are wider
};

/// Sets what parameters say in the frame of `ns`.
void set_frame(const ShadingPoint& p, const HitFrame& hit, PrincipledParameters& out) {
  ShadingFrame<Simd<double, 1, ScalarIsa>> frame(broadcast<OneFloat>(p.ns), broadcast<OneFloat>(p.ng));
  if (hit.stretch) {
    const Vec3f along = only_lane(frame.to_local(broadcast<OneFloat>(*hit.stretch)));
    const float size = std::sqrt(along.x * along.x + along.y * along.y);
    if (size > 0) out.stretch = {along.x / size, along.y / size};
    frame.turn(out.stretch);
  }
  if (!hit.coat_normal) return;
  Vec3<OneFloat> ng, ns;
  face_ray(broadcast<OneFloat>(p.direction), broadcast<OneFloat>(p.surface.geometric_normal),
           broadcast<OneFloat>(*hit.coat_normal), ng, ns);
  out.coat_normal = only_lane(frame.to_local(ns));
}

}  // namespace

/// The material of the side that a ray meets.
static const Material& material_of_side(const RenderContext& context, const Ray& ray,
                                        const SurfaceInteraction& found) {
  const Material& front = material_at(*context.world, found);
  if (front.back == kNoId || !(dot(ray.direction, found.geometric_normal) > 0)) return front;
  return context.world->materials[front.back];
}

ShadingPoint shading_point(const RenderContext& context, const Ray& ray, const Hit& hit,
                           const RayHistory& history, const SurfaceInteraction& found) {
  ShadingPoint p;
  p.material = &material_of_side(context, ray, found);
  const bool by_path = traits(context.settings.kind).traces_paths;
  const bool stretched = by_path && is_stretched(*p.material);
  const bool textured_here = needs_of(context, *p.material).any || stretched;
  const bool framed = stretched || asks_frame(context, *p.material);
  p.surface = framed ? surface_interaction(*context.world->accel, ray, hit) : found;
  p.direction = ray.direction;
  p.t = hit.t;
  const Material& m = *p.material;
  const SurfaceInteraction& s = p.surface;
  TexturePlace place;
  Vec3f ns = s.shading_normal;
  HitFrame frame;
  if (textured_here) {
    TexturedHit textures(context, m, s, hit, ray.direction);
    if (framed) {
      Vec3f x, y;
      pixel_vectors(context, ray, hit, s, history, x, y);
      textures.set_footprints(x, y);
    }
    ns = textures.shading_normal();
    textures.set_normal(ns);
    if (by_path) frame = {textures.coat_normal(), textures.stretch()};
    place = textures.place;
  }
  p.color = color_at(context, m, place);
  p.specular_color = textured(context, m.specular_color, m.specular_texture, place);
  p.emission = textured(context, m.emission, m.emission_texture, place);
  p.values = phong_values(context, m, place);
  p.filter = filter_at(context, m, place);
  p.reflection_color = reflection_color_at(context, m, place);
  p.opacity = opacity_at(context, m, place);
  p.ior = textured(context, m.ior, m.ior_texture, kPhongIors, place);
  if ((textured_here || by_path) && shows_principled(context, m)) set_principled(context, place, p);
  p.normal = ns;
  face_ray(p, ns);
  if (p.principled && (frame.coat_normal || frame.stretch)) set_frame(p, frame, *p.principled);
  if (!p.front && !m.emits_behind) p.emission = {0, 0, 0};
  if (m.reflection_varies && !m.principled) p.values.reflection = varying_reflection(p);
  return p;
}

float index_of_refraction(const ShadingPoint& p) {
  if (!p.material->surface) return 1;
  return p.principled ? p.principled->ior : p.ior;
}

/// The index of refraction of a surface at a place; `place` is not asked without a texture of it.
template <class Place>
static float index_of_refraction(const RenderContext& context, const Material& m, Place&& place) {
  const bool principled = shows_principled(context, m);
  const std::uint32_t texture = principled ? m.principled->ior_texture : m.ior_texture;
  const float ior = principled ? m.principled->parameters.ior : m.ior;
  return texture == kNoId
             ? ior
             : textured(context, ior, texture, principled ? kPrincipledIors : kPhongIors, place());
}

float index_of_refraction(const RenderContext& context, const Ray& ray, const Hit& hit,
                          const SurfaceInteraction& s) {
  const Material& m = material_at(*context.world, s);
  if (!m.surface) return 1;
  return index_of_refraction(context, m, [&] { return texture_place(context, m, ray, hit); });
}

ShownSurface shown_surface(const ShadingPoint& p) {
  ShownSurface shown{p.surface, p.color, p.opacity};
  shown.surface.shading_normal = p.normal;
  return shown;
}

ShownSurface shown_surface(const RenderContext& context, const Ray& ray, const Hit& hit,
                           const RayHistory& history, const SurfaceInteraction& found) {
  const Material& m = material_of_side(context, ray, found);
  if (needs_of(context, m).any) return shown_surface(shading_point(context, ray, hit, history, found));
  return {found, m.color, opacity_at(context, m, {})};
}

bool is_opaque(const Material& m, ShadowRule rule) {
  if (!m.surface) return false;
  return (m.transparency == 0 || rule == ShadowRule::holes_pass) && m.opacity == 1 &&
         m.opacity_texture == kNoId && m.tint_opacity_texture == kNoId;
}

namespace {

/// How smooth glass splits light at a face, colour left out: what goes on, and what stays inside.
struct FaceSplit {
  Vec3d passed;
  double reflected = 0;
};

/// A face of glass that light crosses straight.
struct StraightFace {
  double ior;                    ///< inside relative to what is before it
  double before;                 ///< cosine of the angle of incidence there
  std::optional<double> inside;  ///< that in the glass; nothing where no light gets in

  /// `cosine`: of the angle in air; `own`: index of refraction of the glass relative to air.
  StraightFace(double cosine, double own, double relative) : ior(relative) {
    const double sine2 = std::max(0.0, 1 - cosine * cosine), around = own / relative;
    const double before2 = 1 - sine2 / (around * around), inside2 = 1 - sine2 / (own * own);
    before = std::sqrt(std::max(0.0, before2));
    if (before2 > 0 && inside2 > 0) inside = std::sqrt(inside2);
  }
};

/// Of Phong's model.
FaceSplit split_at(const StraightFace& face, const Material& m, double transparency) {
  if (!m.fresnel && !m.principled) return {{transparency, transparency, transparency}, 0};
  const double reflectance = face.inside ? fresnel(face.before, face.ior) : 1;
  const double passed = transparency * (1 - reflectance);
  return {{passed, passed, passed}, transparency * reflectance};
}

/// Of the principled material, for path tracing. Nothing passes if it scatters the light that it lets
/// through: light samples at the surface itself find the emitter behind it, and light that passed straight
/// would count twice.
FaceSplit split_at(const StraightFace& face, PrincipledParameters p, bool front) {
  p.ior = static_cast<float>(face.ior);
  if (!is_smooth_glass(p)) return {};
  if (!p.thin && !face.inside) return {{}, 1};
  using D = Simd<double, 1, ScalarIsa>;
  const auto cosine = static_cast<float>(front || p.thin ? face.before : *face.inside);
  const Vec3f viewer{std::sqrt(std::max(0.0f, 1 - cosine * cosine)), 0, cosine};
  const PrincipledSurface surface(p, front);
  const Vec3<D> passed = PrincipledLobes<D>(surface, broadcast<FloatsOf<D>>(viewer)).passing_glass();
  // A thin wall has no inside.
  if (p.thin) return {only_lane(passed), 0};
  double reflectance = fresnel(face.before, face.ior);
  if (const GlassSurface& glass = surface; glass.film_weight > 0) {
    const Vec3d film = glass.film.reflectance(face.before);
    reflectance += glass.film_weight * ((film.x + film.y + film.z) / 3 - reflectance);
  }
  return {only_lane(passed), surface.glass * reflectance};
}

}  // namespace

StraightPassage straight_passage(const RenderContext& context, const Ray& ray, const Hit& hit,
                                 const SurfaceInteraction& s, ShadowRule rule, std::optional<float> ior) {
  const Material& m = material_at(*context.world, s);
  std::optional<SurfaceInteraction> whole;
  std::optional<TexturedHit> textures;
  TexturePlace place;
  if (needs_of(context, m).any) {
    if (asks_frame(context, m)) whole = surface_interaction(*context.world->accel, ray, hit);
    textures.emplace(context, m, whole ? *whole : s, hit, ray.direction);
    place = textures->place;
  }
  const float opacity = opacity_at(context, m, place), hole = 1 - opacity;
  StraightPassage passage{{hole, hole, hole}, 0, !(dot(ray.direction, s.geometric_normal) > 0)};
  if (m.transparency == 0 || rule == ShadowRule::holes_pass) return passage;
  const Vec3d normal(textures ? textures->shading_normal() : s.shading_normal), d(ray.direction);
  const double cosine = std::min(1.0, std::abs(dot(d, normal)) / (length(d) * length(normal)));
  const bool by_path = m.principled && traits(context.settings.kind).traces_paths;
  const double own = static_cast<double>(index_of_refraction(context, m, [&] { return place; }));
  const StraightFace face(cosine, own, ior ? static_cast<double>(*ior) : own);
  const Color color = color_at(context, m, place);
  const FaceSplit split =
      by_path ? split_at(face, principled_at(context, *m.principled, color, place), passage.front)
              : split_at(face, m, static_cast<double>(transparency_at(context, m, place)));
  const Color filter = by_path ? color : filter_at(context, m, place).value_or(color);
  for (int k = 0; k < 3; ++k)
    passage.passed[k] = filter[k] * (static_cast<float>(split.passed[k]) * opacity) + passage.passed[k];
  passage.reflected = std::clamp(static_cast<float>(split.reflected) * opacity, 0.0f, 1.0f);
  return passage;
}

Color passing_holes(const RenderContext& context, const Ray& ray, const Hit& hit,
                    const SurfaceInteraction& s) {
  const Material& m = material_at(*context.world, s);
  const float hole = 1 - opacity_at(context, m, texture_place(context, m, ray, hit));
  return {hole, hole, hole};
}

}  // namespace oktett
