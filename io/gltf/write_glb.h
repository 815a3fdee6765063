#pragma once
/// \file Writing GLB files. Within io/ only.

#include <string>

#include "io/mesh/mesh_file.h"
#include "io/mesh/mesh_output.h"

namespace oktett {

/// Writes the mesh as one node of a glTF 2.0 file of bytes, with its materials and their images. Returns what
/// glTF cannot say. Throws Error of kind io if that fails.
MeshLosses write_glb(const std::string& path, const MeshFile& file);

}  // namespace oktett
