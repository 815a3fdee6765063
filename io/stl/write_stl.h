#pragma once
/// \file Writing STL meshes. Within io/ only.

#include <string>

#include "io/mesh/mesh_file.h"
#include "io/mesh/mesh_output.h"

namespace oktett {

/// Writes the triangles with their geometric normals: bytes, or text if `ascii`. Returns what STL cannot say.
/// Throws Error of kind io if that fails.
MeshLosses write_stl(const std::string& path, const MeshFile& file, bool ascii);

}  // namespace oktett
