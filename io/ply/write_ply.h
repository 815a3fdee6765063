#pragma once
/// \file Writing PLY meshes. Within io/ only.

#include <string>

#include "io/mesh/mesh_file.h"
#include "io/mesh/mesh_output.h"

namespace oktett {

/// Writes positions, normals, texture coordinates and triangles: bytes in little-endian order, or text if
/// `ascii`. Returns what PLY cannot say. Throws Error of kind io if that fails.
MeshLosses write_ply(const std::string& path, const MeshFile& file, bool ascii);

}  // namespace oktett
