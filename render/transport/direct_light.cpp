#include "render/transport/direct_light.h"

#include <algorithm>

#include "accel/surface/offset_origin.h"
#include "core/platform.h"
#include "render/bsdf/phong_power.h"
#include "render/transport/shading_lanes.h"

namespace oktett {

float highlight_power(float cosine, float exponent) {
  return static_cast<float>(phong_power(cosine, exponent));
}

using Lane = Simd<float, 1, ScalarIsa>;

static OKTETT_INLINE Color phong_here(const ShadingPoint& p, const Vec3f& l) {
  const auto cosines = phong_cosines(broadcast<Lane>(p.direction), broadcast<Lane>(p.ng),
                                     broadcast<Lane>(p.ns), broadcast<Lane>(l));
  const float cosine = cosines.cosine.part[0].v, highlight = cosines.highlight.part[0].v;
  // NaN is not left out: it goes on to the picture, where it is counted.
  if (cosine <= 0) return {0, 0, 0};
  return phong_sum(p.values, p.color, p.specular_color, cosine, highlight,
                   [&] { return highlight_power(std::min(highlight, 1.0f), p.values.phong); });
}

Color phong(const ShadingPoint& p, const Vec3f& l) { return phong_here(p, l); }

/// The ray from `p` to a light and the light that travels along it.
static OKTETT_INLINE Ray light_ray(const ShadingPoint& p, const LightSource& light, Vec3f& l, Color& color) {
  Ray ray;
  color = light.color;
  if (light.directional) {
    l = ray.direction = light.place;
    offset_origin(p.surface, l, ray.origin);
    return ray;
  }
  Vec3<Lane> towards;
  const auto square = turn_to_light(light.place, broadcast<Lane>(p.surface.position), towards);
  l = only_lane(towards);
  if (light.falloff) color = color * only_lane(falloff(square));
  if (light.spot)
    color =
        color * spot_share(-dot_lanes(towards, broadcast<Lane>(light.axis)), light.cos_inner, light.cos_outer)
                    .part[0]
                    .v;
  if (light.profile.profile != nullptr) color = color * light.profile(-Vec3d(l));
  Vec3<Lane> end = broadcast<Lane>(light.place);
  if (light.glows) color = color * only_lane(glow(towards, light, end));
  offset_origin(p.surface, l, ray.origin);
  ray.direction = only_lane(end) - ray.origin;
  ray.tmax = kBeforeLight;
  return ray;
}

void add_light(const ShadingPoint& p, const Color& throughput, const LightSource& light, std::uint32_t owner,
               ShadowQueue& queue) {
  Vec3f l;
  Color color;
  const Ray ray = light_ray(p, light, l, color);
  const Color arriving = throughput * phong_here(p, l) * color;
  if (!(arriving == Color{0, 0, 0})) queue.push_back(ray, owner, arriving);
}

void add_direct_light(const RenderContext& context, const ShadingPoint& p, const Color& throughput,
                      std::uint32_t pattern, std::uint32_t owner, std::vector<ShadowQueue>& shadows) {
  const std::size_t points = context.lights.size();
  for (std::size_t i = 0; i < points; ++i) add_light(p, throughput, context.lights[i], owner, shadows[i]);
  const AreaLights& area = context.area_lights;
  for (std::size_t i = 0; i < area.samples; ++i)
    add_light(p, throughput, area.points[std::size_t{pattern} * area.samples + i], owner,
              shadows[points + i]);
}

}  // namespace oktett
