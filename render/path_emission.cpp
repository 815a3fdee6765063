#include "render/path_emission.h"

namespace oktett {

float power_weight(float pdf, float other) {
  // Divided first: squares of densities may be too large for a float.
  const float ratio = other / pdf;
  return 1 / (1 + ratio * ratio);
}

/// The weight of light that entry `ray` meets, if a light sample would have found it with density
/// `light_pdf`.
template <class LightPdf>
static float met_weight(const Wavefront& wavefront, std::size_t ray, const LightPdf& light_pdf) {
  if (wavefront.level == 0) return 1;
  const float pdf = wavefront.paths.pdf[ray];
  return pdf == 0 ? 1 : power_weight(pdf, light_pdf(wavefront.paths.from[ray]));
}

float emission_weight(const RenderContext& context, const Wavefront& wavefront, std::size_t ray,
                      const Vec3f& position) {
  return met_weight(wavefront, ray, [&](const LightPoint& from) {
    const std::uint32_t emitter = context.sampled->emitter_at(wavefront.hits[ray]);
    if (emitter == kNoId) return 0.0f;
    return context.sampled->set().pdf(from, emitter, wavefront.rays.rays[ray].direction,
                                      length(position - from.position));
  });
}

float environment_weight(const RenderContext& context, const Wavefront& wavefront, std::size_t ray) {
  return met_weight(wavefront, ray, [&](const LightPoint& from) {
    return context.sampled->set().environment_pdf(from, wavefront.rays.rays[ray].direction);
  });
}

}  // namespace oktett
