#pragma once
/// \file Files that place meshes, with the materials and all else that they show. Within io/ only.

#include <string>

#include "io/gltf/gltf_options.h"
#include "io/mesh/file_scene.h"

namespace oktett {

/// Whether files of the format of `path` place meshes: 3MF and glTF.
bool has_file_scene(const std::string& path);

/// What such a file shows. Throws Error as load_mesh does, also for options that are for glTF files
/// unless it is one.
FileScene load_file_scene(const std::string& path, const GltfOptions& options);

}  // namespace oktett
