#pragma once
/// \file STL meshes, as text and as bytes. Within io/ only.

#include <string>

#include "io/mesh/mesh_file.h"
#include "io/mesh/mesh_output.h"
#include "io/mesh/reading.h"

namespace oktett {

/// Reads `path`. Every triangle has three vertices of its own. Normals and attributes of facets are not used.
/// Throws Error with the line, or the byte, for what the format does not allow, with ErrorKind::io if the
/// file cannot be read.
ParsedMesh parse_stl(const std::string& path, const MeshReadOptions& options = {});

/// Writes the triangles with their geometric normals: bytes, or text if `ascii`. Returns what STL cannot say.
/// Throws Error of kind io if that fails.
MeshLosses write_stl(const std::string& path, const MeshFile& file, bool ascii);

}  // namespace oktett
