#pragma once
/// \file The weight in path tracing of light that a ray meets: against light samples that find the same, and
/// none where photons bring it.

#include "render/transport/wavefront.h"

namespace oktett {

/// Veach's power heuristic for a light that two ways of sampling can find with these densities: the weight of
/// the first.
float power_weight(float pdf, float other);

/// The weight of the light that the surface at `position`, the hit of entry `ray`, emits. `emitter`: its
/// number, see SceneLights::emitter_at.
float emission_weight(const RenderContext& context, const Wavefront& wavefront, std::size_t ray,
                      const Vec3f& position, std::uint32_t emitter);

/// Whether entry `ray` came from mirrors or glass that were met after a surface that scatters otherwise: the
/// lights that it meets are those that photons bring.
inline bool is_caustic(const RenderContext& context, const Wavefront& wavefront, std::size_t ray) {
  return context.caustics != nullptr && wavefront.level > 0 && wavefront.paths.pdf[ray] == 0 &&
         wavefront.paths.scattered[ray] != 0;
}

}  // namespace oktett
