#pragma once
/// \file What fills the ways of rays in Whitted's model: fog and media.

#include <cstdint>

#include "accel/interaction_block.h"
#include "render/transport/wavefront.h"

namespace oktett {

// All are for pictures that track insides, see RenderContext::tracks_insides.

/// Veils what rays of the wavefront that meet nothing have found.
void veil_misses(const RenderContext& context, Wavefront& wavefront);

/// Weakens the rays which[0], ..., which[count - 1], by what fills their
/// ways, adds its light to their radiance, and queues rays to the lamps whose light it scatters.
void veil_hits(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
               std::size_t count);

/// The solids around a ray that goes on from the hit of entry `ray`, which is entry k of `found`: through the
/// surface, or back.
Insides insides_behind(const RenderContext& context, const Wavefront& wavefront, std::uint32_t ray,
                       const InteractionBlock& found, std::size_t k);

}  // namespace oktett
