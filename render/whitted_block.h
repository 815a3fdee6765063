#pragma once
/// \file Whitted's shading of many hits at once: normals, directions to lights and Phong's cosines in
/// columns.

#include <cstdint>

#include "accel/interaction_block.h"
#include "render/wavefront.h"

namespace oktett {

/// What shade_whitted does for each of the rays `which[0]` ... `which[count - 1]` of the wavefront, whose
/// surfaces are `found`, to the same bits. None of them may need the picture's data layers. Hits of materials
/// with textures are shaded one by one.
void shade_whitted_block(const RenderContext& context, Wavefront& wavefront, const std::uint32_t* which,
                         std::size_t count, const InteractionBlock& found);

}  // namespace oktett
