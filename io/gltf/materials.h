#pragma once
/// \file Materials of glTF files as ours. Within io/ only.

#include "io/gltf/gltf.h"
#include "io/gltf/gltf_file.h"

namespace oktett {

/// How steeply a mask goes from nothing to all: a hard edge, as glTF has it.
inline constexpr float kGltfMaskSlope = 1e4f;

/// Sets the materials and textures of `scene`; the images of textures that are not in files are copied from
/// the buffers. Throws Error.
void add_gltf_materials(const GltfFile& file, GltfScene& scene);

}  // namespace oktett
