#pragma once
/// \file Scenes in glTF 2.0 files, read and written. Within io/ only.

#include <string>

#include "io/gltf/gltf_options.h"
#include "io/mesh/file_scene.h"
#include "io/mesh/mesh_file.h"
#include "io/mesh/mesh_output.h"

namespace oktett {

/// Reads the default scene of a .gltf or .glb file, and the buffers beside it; what moves does so as
/// GltfOptions::shutter says. Throws Error, with ErrorKind::io if a file cannot be read. Image files are not
/// read.
FileScene load_gltf_scene(const std::string& path, const GltfOptions& options = {});

/// Whether the name of a file is that of a glTF file.
bool is_gltf_file(const std::string& path);

/// Writes the mesh as one node of a glTF 2.0 file of bytes, with its materials and their images. Returns what
/// glTF cannot say. Throws Error of kind io if that fails.
MeshLosses write_glb(const std::string& path, const MeshFile& file);

}  // namespace oktett
