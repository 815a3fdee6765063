#include "render/whitted_block.h"

#include <algorithm>

#include "core/platform.h"
#include "render/direct_light.h"
#include "render/integrators.h"
#include "render/render_code.h"

namespace oktett {
namespace {

/// The shadow ray of hit `k` of the columns.
Ray shadow_ray(const ShadingColumns& c, std::size_t k, const LightSource& light) {
  Ray ray;
  ray.origin = InteractionBlock::get(c.origin, k);
  if (light.directional) {
    ray.direction = light.place;
  } else {
    ray.direction = light.place - ray.origin;
    ray.tmax = kBeforeLight;
  }
  return ray;
}

/// Shades hit `i` alone. A plain hit is already lit, so only its mirror and refracted rays are queued.
OKTETT_NOINLINE void shade_alone(const RenderContext& context, Wavefront& wavefront, std::uint32_t i,
                                 const SurfaceInteraction& found, bool plain) {
  const ShadingPoint p =
      shading_point(context, wavefront.rays.rays[i], wavefront.hits[i],
                    {wavefront.rays.distance[i], wavefront.rays.from_camera[i] != 0}, found);
  if (plain) return push_specular(context, wavefront, i, p, wavefront.rays.throughput[i]);
  if (wavefront.rays.from_camera[i])
    wavefront.samples.alpha[wavefront.rays.sample[i]] += wavefront.rays.throughput[i].x * p.opacity;
  shade_whitted(context, wavefront, i, p);
}

}  // namespace

void shade_whitted_block(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
                         std::size_t count, const InteractionBlock& found) {
  const RenderCode& code = render_code(context.isa);
  ShadingColumns c;
  c.count = count;
  const Material* materials[ShadingColumns::kMost];
  bool plain[ShadingColumns::kMost];
  for (std::size_t k = 0; k < count; ++k) {
    materials[k] = &material_at(*context.world, found.user[k], found.material_slot[k]);
    plain[k] = context.textures == nullptr || !has_textures(*materials[k]);
    const Material& m = *materials[k];
    c.exponent[k] = m.specular != 0 && by_squaring(m.phong) ? static_cast<std::int32_t>(m.phong) : 0;
    c.greatest_exponent = std::max(c.greatest_exponent, c.exponent[k]);
    for (int axis = 0; axis < 3; ++axis) c.direction[axis][k] = wavefront.rays.rays.direction[axis][which[k]];
  }
  for (std::size_t k = count; k % 8 != 0; ++k) {
    c.exponent[k] = 0;
    for (int axis = 0; axis < 3; ++axis) c.direction[axis][k] = 0;
  }
  code.face_rays(found, c);
  for (std::size_t n = 0; n < context.lights.size(); ++n) {
    const LightSource& light = context.lights[n];
    code.meet_light(found, light, c);
    // Memory for all of them at once: push_back checks the capacity of each column for each ray.
    ShadowQueue& queue = wavefront.shadows[n];
    std::size_t end = queue.size();
    queue.resize_uninitialized(end + count);
    for (std::size_t k = 0; k < count; ++k) {
      if (!plain[k] || c.cosine[k] <= 0) continue;
      const Material& m = *materials[k];
      const Color shine = phong_sum(m, m.color, m.specular_color, c.cosine[k], c.highlight[k], [&] {
        if (by_squaring(m.phong)) return c.power[k];
        return highlight_power(std::min(c.highlight[k], 1.0f), m.phong);
      });
      const Color color = !light.directional && light.falloff ? light.color * c.falloff[k] : light.color;
      const Color arriving = wavefront.rays.throughput[which[k]] * shine * color;
      if (arriving == Color{0, 0, 0}) continue;
      queue.set(end++, shadow_ray(c, k, light), which[k], arriving);
    }
    queue.resize_uninitialized(end);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = which[k];
    const Material& m = *materials[k];
    if (plain[k]) {
      if (wavefront.rays.from_camera[i])
        wavefront.samples.alpha[wavefront.rays.sample[i]] += wavefront.rays.throughput[i].x;
      wavefront.radiance[i] +=
          wavefront.rays.throughput[i] * (m.emission + m.color * m.ambient * context.ambient_light);
    }
    if (!plain[k] || m.reflection != 0 || m.transparency != 0)
      shade_alone(context, wavefront, i, found[k], plain[k]);
  }
}

}  // namespace oktett
