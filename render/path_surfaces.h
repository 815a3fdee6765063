#pragma once
/// \file The materials of a scene, prepared for path tracing in blocks.

#include <vector>

#include "render/geometry.h"
#include "render/path_block.h"
#include "render/texture_sampler.h"

namespace oktett {

/// Two entries for each material of `world`, see PathSurface. `textures` may be null.
std::vector<PathSurface> path_surfaces(const World& world, const TextureSampler* textures);

}  // namespace oktett
