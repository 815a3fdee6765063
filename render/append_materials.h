#pragma once
/// \file Materials that join those of a scene.

#include <cstdint>
#include <vector>

#include "render/scene.h"

namespace oktett {

/// Appends materials with what they refer to by numbers that count from 0: textures and media. Returns the
/// number of the first material in `scene`.
std::uint32_t append_materials(std::vector<Material> materials, std::vector<Texture> textures,
                               std::vector<Medium> media, Scene& scene);

}  // namespace oktett
