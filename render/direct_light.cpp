#include "render/direct_light.h"

#include <algorithm>

#include "accel/accel.h"
#include "core/math.h"

namespace oktett {

Color phong(const ShadingPoint& p, const Vec3f& l) {
  const Material& m = *p.material;
  const float cosine = dot(p.ns, l);
  // Comparisons are such that NaN goes on to the picture, where it is counted.
  if (cosine <= 0 || dot(p.ng, l) <= 0) return {0, 0, 0};
  Color sum = p.color * (m.diffuse * cosine);
  if (m.specular != 0) {
    const float highlight = dot(l, p.direction) - 2 * cosine * dot(p.ns, p.direction);
    if (!(highlight <= 0)) {
      const double power = portable::pow(std::min(highlight, 1.0f), m.phong);
      sum += p.specular_color * (m.specular * static_cast<float>(power));
    }
  }
  return sum;
}

/// The ray from `p` to a light and the light that travels along it.
static Ray light_ray(const ShadingPoint& p, const LightSource& light, Vec3f& l, Color& color) {
  Ray ray;
  color = light.color;
  if (light.directional) {
    l = ray.direction = light.place;
    ray.origin = offset_origin(p.surface, l);
    return ray;
  }
  const Vec3d towards = Vec3d(light.place) - Vec3d(p.surface.position);
  const double square = dot(towards, towards);
  l = Vec3f(towards / std::sqrt(square));
  if (light.falloff) color = color * static_cast<float>(1 / square);
  ray.origin = offset_origin(p.surface, l);
  ray.direction = light.place - ray.origin;
  ray.tmax = 1 - 0x1p-24f;
  return ray;
}

void add_direct_light(const RenderContext& context, const ShadingPoint& p, const Color& throughput,
                      std::uint32_t owner, ShadowQueue& shadows) {
  for (const LightSource& light : context.lights) {
    Vec3f l;
    Color color;
    const Ray ray = light_ray(p, light, l, color);
    const Color arriving = throughput * phong(p, l) * color;
    if (arriving == Color{0, 0, 0}) continue;
    shadows.push_back(ray, owner, arriving);
  }
}

}  // namespace oktett
