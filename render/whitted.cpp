#include "render/direct_light.h"
#include "render/integrators.h"
#include "render/specular.h"

namespace oktett {

static bool is_black(const Color& c) { return c == Color{0, 0, 0}; }

void shade_whitted(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                   const ShadingPoint& p) {
  const Color arriving = wavefront.rays.throughput[ray];
  const Color throughput = arriving * p.opacity;
  const Material& m = *p.material;
  wavefront.radiance[ray] += throughput * (p.emission + p.color * m.ambient * context.ambient_light);
  add_direct_light(context, p, throughput, static_cast<std::uint32_t>(ray), wavefront.shadows);

  if (p.opacity < 1)
    push_bounce(wavefront, ray, p, p.direction, arriving * (1 - p.opacity), Bounce::straight);
  push_specular(context, wavefront, ray, p, throughput);
}

void push_specular(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p,
                   const Color& throughput) {
  if (wavefront.rays.bounces[ray] >= context.settings.depth) return;
  const SpecularRays specular = specular_rays(p);
  if (!is_black(specular.mirror))
    push_bounce(wavefront, ray, p, specular.mirror_direction, throughput * specular.mirror,
                Bounce::reflected);
  if (!is_black(specular.refracted))
    push_bounce(wavefront, ray, p, specular.refracted_direction, throughput * specular.refracted,
                Bounce::refracted);
}

}  // namespace oktett
