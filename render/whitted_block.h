#pragma once
/// \file Whitted's shading of many hits at once: normals, directions to lights and Phong's cosines in
/// columns.

#include <cstdint>

#include "accel/interaction_block.h"
#include "render/wavefront.h"

namespace oktett {

/// Shades the hits of rays `which[0]` ... `which[count - 1]` of the wavefront, whose surface interactions are
/// `found`, with the same bits as shade_whitted. For pictures without data layers. Hits of materials with
/// textures are shaded one by one.
void shade_whitted_block(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
                         std::size_t count, const InteractionBlock& found);

}  // namespace oktett
