#pragma once
/// \file What lies under a pixel.

#include <cstdint>
#include <string>

#include "core/isa.h"
#include "render/picture/prepared_scene.h"

namespace oktett {

/// What the ray through the centre of a pixel meets, as one JSON object; the pixel counts from the upper left
/// corner of the part of the frame that is rendered. Numbers have as many digits as give back the bits that
/// closest_hit and surface_interaction give. Of a combination the operand counts whose
/// surface is hit. Motion is left out: things stand where they are at time 0. Throws Error for a pixel
/// outside. While another thread renders, `prepared` may be asked.
std::string pick_json(const PreparedScene& prepared, const Camera& camera, const Film& film, std::uint32_t x,
                      std::uint32_t y, Isa isa);

}  // namespace oktett
