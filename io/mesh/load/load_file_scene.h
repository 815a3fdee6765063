#pragma once
/// \file Files that place meshes, with the materials and all else that they show. Within io/ only.

#include <string>

#include "io/gltf/gltf_options.h"
#include "io/mesh/file_scene.h"

namespace oktett {

/// Whether files of the format of `path` place meshes: 3MF and glTF.
bool has_file_scene(const std::string& path);

/// Throws Error if something is asked that only glTF files have, unless it is one.
void check_gltf_options(const std::string& path, const GltfOptions& options);

/// What a file of several meshes shows. Throws Error as load_mesh and check_gltf_options do.
FileScene load_file_scene(const std::string& path, const GltfOptions& options);

}  // namespace oktett
