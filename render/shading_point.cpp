#include "render/shading_point.h"

#include <algorithm>
#include <cmath>

#include "accel/accel.h"
#include "render/shading_lanes.h"

namespace oktett {
namespace {

/// Changes of uv across a pixel.
struct Footprint {
  Vec2f dx, dy;
};

/// The footprint from vectors in the tangent plane. dp/dv is not known; it is assumed to be as long as dp/du
/// and perpendicular to it, which is exact for textures without distortion.
Footprint footprint(const SurfaceInteraction& s, const Vec3f& x, const Vec3f& y, float scale) {
  const float square = dot(s.tangent, s.tangent);
  const Vec3f du = s.tangent * (scale / square);
  const Vec3f dv = cross(s.geometric_normal, du);
  const Footprint f{{dot(x, du), dot(x, dv)}, {dot(y, du), dot(y, dv)}};
  const bool known = square > 0 && std::isfinite(f.dx.x) && std::isfinite(f.dx.y) && std::isfinite(f.dy.x) &&
                     std::isfinite(f.dy.y);
  return known ? f : Footprint{};
}

/// The neighbours of a camera ray are known. Other rays count as cones with the angle of a pixel.
Footprint texture_footprint(const RenderContext& c, const Ray& ray, const Hit& hit,
                            const SurfaceInteraction& s, const RayHistory& history) {
  Vec3f x, y;
  if (history.from_camera && history.distance == 0) {
    pixel_footprint(c.camera, ray, s.position, s.geometric_normal, x, y);
  } else {
    const bool perspective = c.camera.projection == Projection::perspective;
    const auto width = static_cast<float>(c.camera.pixel_size * (perspective ? history.distance + hit.t : 1));
    make_basis(s.geometric_normal, x, y);
    x *= width, y *= width;
  }
  return footprint(s, x, y, c.footprint_scale);
}

Color textured(const RenderContext& c, const Color& color, std::uint32_t texture, const Vec2f& uv,
               const Footprint& f) {
  if (texture == kNoId || c.textures == nullptr) return color;
  return color * c.textures->color(texture, uv, f.dx, f.dy);
}

float opacity_at(const RenderContext& c, const Material& m, const Vec2f& uv, const Footprint& f) {
  if (!m.surface) return 0;
  if (m.opacity_texture == kNoId || c.textures == nullptr) return 1;
  return std::clamp(c.textures->value(m.opacity_texture, uv, f.dx, f.dy), 0.0f, 1.0f);
}

PrincipledParameters principled_at(const RenderContext& c, const PrincipledMaterial& m, const Color& color,
                                   const Vec2f& uv, const Footprint& f) {
  PrincipledParameters at = m.parameters;
  at.base_color = color;
  if (c.textures == nullptr) return at;
  for (const PrincipledNumber& number : kPrincipledNumbers)
    if (const std::uint32_t texture = m.*number.texture; texture != kNoId)
      at.*number.value *= c.textures->value(texture, uv, f.dx, f.dy);
  at.sheen_color = textured(c, at.sheen_color, m.sheen_color_texture, uv, f);
  return at;
}

/// The normal of the surface displaced by a height map along `n` (Blinn 1978), dp/dv as in `footprint`.
Vec3f bumped(const RenderContext& c, const Material& m, const SurfaceInteraction& s, const Vec3f& n,
             const Footprint& f) {
  const float size = length(s.tangent);
  if (!(size > 0)) return n;
  const Vec3f t = s.tangent / size, b = cross(n, t);
  const auto step = [](float across, float down) {
    return std::max(0.5f * (std::abs(across) + std::abs(down)), 0x1p-11f);
  };
  const float du = step(f.dx.x, f.dy.x), dv = step(f.dx.y, f.dy.y);
  const auto height = [&](float u, float v) {
    return m.bump_scale * c.textures->value(m.bump_texture, {s.uv.x + u, s.uv.y + v}, f.dx, f.dy);
  };
  const float here = height(0, 0);
  const Vec3f bent = n * size - t * ((height(du, 0) - here) / du) - b * ((height(0, dv) - here) / dv);
  return is_finite(bent) && dot(bent, bent) > 0 ? normalize(bent) : n;
}

/// The normal from a tangent-space normal map.
Vec3f mapped(const RenderContext& c, const Material& m, const SurfaceInteraction& s, const Vec3f& n,
             const Footprint& f) {
  const Vec3f flat = s.tangent - n * dot(s.tangent, n);
  if (!(dot(flat, flat) > 0)) return n;
  const Vec3f t = normalize(flat), b = cross(n, t);
  const Vec3f texel = c.textures->normal(m.normal_texture, s.uv, f.dx, f.dy) * 2 - Vec3f{1, 1, 1};
  const Vec3f bent = t * texel.x + b * texel.y + n * texel.z;
  return is_finite(bent) && dot(bent, bent) > 0 ? normalize(bent) : n;
}

/// Sets `front`, `ng` and `ns`.
void face_ray(ShadingPoint& p, const Vec3f& shading_normal) {
  using F = Simd<float, 1, ScalarIsa>;
  Vec3<F> ng, ns;
  p.front = none(face_ray(broadcast<F>(p.direction), broadcast<F>(p.surface.geometric_normal),
                          broadcast<F>(shading_normal), ng, ns));
  p.ng = only_lane(ng), p.ns = only_lane(ns);
}

}  // namespace

ShadingPoint shading_point(const RenderContext& context, const Ray& ray, const Hit& hit,
                           const RayHistory& history, const SurfaceInteraction& found) {
  ShadingPoint p;
  p.material = &material_at(*context.world, found);
  const bool textured_here = context.textures != nullptr && has_textures(*p.material);
  const bool uv_shown =
      (context.data_layers && history.from_camera) || context.settings.kind == IntegratorKind::uv;
  p.surface = textured_here || uv_shown ? surface_interaction(*context.world->accel, ray, hit) : found;
  p.direction = ray.direction;
  p.t = hit.t;
  const Material& m = *p.material;
  const SurfaceInteraction& s = p.surface;
  Footprint f;
  Vec3f ns = s.shading_normal;
  if (textured_here) {
    f = texture_footprint(context, ray, hit, s, history);
    if (m.bump_texture != kNoId) ns = bumped(context, m, s, ns, f);
    if (m.normal_texture != kNoId) ns = mapped(context, m, s, ns, f);
  }
  p.color = textured(context, m.color, m.color_texture, s.uv, f);
  p.specular_color = textured(context, m.specular_color, m.specular_texture, s.uv, f);
  p.emission = textured(context, m.emission, m.emission_texture, s.uv, f);
  p.opacity = opacity_at(context, m, s.uv, f);
  p.ior = m.ior;
  if (m.principled && context.settings.kind == IntegratorKind::path)
    p.principled = principled_at(context, *m.principled, p.color, s.uv, f);
  face_ray(p, ns);
  if (!p.front && !m.emits_behind) p.emission = {0, 0, 0};
  return p;
}

static bool has_textures(const PrincipledMaterial& m) {
  for (const PrincipledNumber& number : kPrincipledNumbers)
    if (m.*number.texture != kNoId) return true;
  return m.sheen_color_texture != kNoId;
}

bool has_textures(const Material& m) {
  if (m.principled && has_textures(*m.principled)) return true;
  return m.color_texture != kNoId || m.specular_texture != kNoId || m.emission_texture != kNoId ||
         m.opacity_texture != kNoId || m.bump_texture != kNoId || m.normal_texture != kNoId;
}

bool is_opaque(const Material& m, ShadowRule rule) {
  if (!m.surface) return false;
  return (m.transparency == 0 || rule == ShadowRule::holes_pass) && m.opacity_texture == kNoId;
}

Color transmittance(const RenderContext& context, const Ray& ray, const Hit& hit, const SurfaceInteraction& s,
                    ShadowRule rule) {
  const Material& m = material_at(*context.world, s);
  Vec2f uv;
  if (context.textures != nullptr && has_textures(m))
    uv = surface_interaction(*context.world->accel, ray, hit).uv;
  const float opacity = opacity_at(context, m, uv, {});
  const float hole = 1 - opacity;
  if (m.transparency == 0 || rule == ShadowRule::holes_pass) return {hole, hole, hole};
  const Color color = textured(context, m.color, m.color_texture, uv, {});
  return color * (m.transparency * opacity) + Color{hole, hole, hole};
}

}  // namespace oktett
