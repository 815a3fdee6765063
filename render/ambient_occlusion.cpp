#include "accel/accel.h"
#include "core/random.h"
#include "render/integrators.h"
#include "render/sampling.h"

namespace oktett {

void shade_ambient_occlusion(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                             const ShadingPoint& p) {
  const std::uint32_t sample = wavefront.rays.sample[ray];
  const std::uint64_t pattern = pattern_key(wavefront.samples.key[sample], 1);
  SquareSample at = stratified_sample(wavefront.samples.number[sample], context.settings.samples, pattern);
  if (context.settings.samples == 1) at = {random_float(pattern, 0, 2), random_float(pattern, 0, 3)};
  const Vec3f direction = cosine_direction(p.ns, at);
  if (dot(direction, p.ng) <= 0) return;
  const Ray probe{offset_origin(p.surface, direction), 0, direction, context.ao_radius};
  wavefront.shadows.front().push_back(probe, static_cast<std::uint32_t>(ray), wavefront.rays.throughput[ray]);
}

}  // namespace oktett
