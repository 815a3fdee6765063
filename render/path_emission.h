#pragma once
/// \file The weight in path tracing of light that a ray meets: against light samples that find the same, and
/// none where photons bring it.

#include "render/wavefront.h"

namespace oktett {

/// Veach's power heuristic for a light that two ways of sampling can find with these densities: the weight of
/// the first.
float power_weight(float pdf, float other);

/// The weight of the light that the surface at `position`, the hit of entry `ray`, emits.
float emission_weight(const RenderContext& context, const Wavefront& wavefront, std::size_t ray,
                      const Vec3f& position);

}  // namespace oktett
