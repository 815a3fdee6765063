#include "render/transport/path_emission.h"

#include "render/photon/caustics.h"

namespace oktett {

float power_weight(float pdf, float other) {
  // Divided first: squares of densities may be too large for a float.
  const float ratio = other / pdf;
  return 1 / (1 + ratio * ratio);
}

float emission_weight(const RenderContext& context, const Wavefront& wavefront, std::size_t ray,
                      const Vec3f& position, std::uint32_t emitter) {
  if (wavefront.level == 0) return 1;
  const float pdf = wavefront.paths.pdf[ray];
  if (pdf == 0 && !is_caustic(context, wavefront, ray)) return 1;
  const LightPoint& from = wavefront.paths.from[ray];
  if (pdf == 0) return emitter != kNoId && context.caustics->brings(emitter) ? 0.0f : 1.0f;
  if (emitter == kNoId) return power_weight(pdf, 0);
  return power_weight(pdf, context.sampled->set().pdf(from, emitter, wavefront.rays.rays[ray].direction,
                                                      length(position - from.position)));
}

}  // namespace oktett
