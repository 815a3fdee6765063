#pragma once
/// \file The materials of a scene, prepared for path tracing in blocks.

#include <vector>

#include "render/geometry.h"
#include "render/transport/path_block.h"

namespace oktett {

/// Two entries for each material of `world`, see PathSurface.
std::vector<PathSurface> path_surfaces(const World& world);

}  // namespace oktett
