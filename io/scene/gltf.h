#pragma once
/// \file Whole scenes from glTF files. Within io/ only.

#include <string>

#include "io/gltf/gltf.h"
#include "render/scene.h"

namespace oktett {

/// Adds the objects of `file`, which was read from `path`, with their materials and lights to `scene`. Its
/// camera replaces that of the scene. A mesh that several nodes show becomes a prototype.
void add_gltf(const std::string& path, GltfScene file, Scene& scene);

}  // namespace oktett
