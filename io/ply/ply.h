#pragma once
/// \file PLY meshes, as text and as bytes of either order. Within io/ only.

#include <string>

#include "io/mesh/parsed_mesh.h"

namespace oktett {

/// Reads `path`: positions, normals and texture coordinates of the element `vertex`, polygons of `face` and
/// strips of `tristrips`. Throws Error with the line, or the byte, for what the format does not allow, with
/// ErrorKind::io if the file cannot be read.
ParsedMesh parse_ply(const std::string& path, const MeshReadOptions& options = {});

}  // namespace oktett
