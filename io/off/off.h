#pragma once
/// \file OFF meshes (Geomview's Object File Format), as text. Within io/ only.

#include <string>

#include "io/mesh/mesh_file.h"
#include "io/mesh/reading.h"

namespace oktett {

/// Reads `path`: a header `OFF` with any of the prefixes `ST`, `C` and `N`, or none at all; the numbers of
/// vertices, faces and edges, which may follow `OFF` without a blank, as in ModelNet; vertices with normals,
/// colours and texture coordinates as the prefixes say; faces with or without a colour. Colours are not used,
/// with a warning. Throws Error with the line for what the format does not allow, for bytes (`OFF BINARY`)
/// and for other dimensions than three, with ErrorKind::io if the file cannot be read.
ParsedMesh parse_off(const std::string& path, const MeshReadOptions& options = {});

}  // namespace oktett
