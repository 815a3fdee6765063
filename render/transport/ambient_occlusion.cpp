#include "accel/accel.h"
#include "render/sampling/owen_sobol.h"
#include "render/sampling/warp.h"
#include "render/transport/integrators.h"
#include "render/transport/sample_dimensions.h"

namespace oktett {

void shade_ambient_occlusion(const RenderContext& context, Wavefront& wavefront, std::size_t ray,
                             const ShadingPoint& p) {
  const std::uint32_t sample = wavefront.rays.sample[ray];
  const std::uint64_t directions =
      sequence_key(wavefront.samples.key[sample], dimension(Decision::direction));
  const SquareSample at = sobol_point(wavefront.samples.number[sample], directions);
  const Vec3f direction = cosine_direction(p.ns, at);
  if (dot(direction, p.ng) <= 0) return;
  const Ray probe{offset_origin(p.surface, direction), 0, direction, context.ao_radius};
  wavefront.shadows.front().push_back(probe, static_cast<std::uint32_t>(ray), wavefront.rays.throughput[ray]);
}

}  // namespace oktett
