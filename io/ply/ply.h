#pragma once
/// \file PLY meshes, as text and as bytes of either order. Within io/ only.

#include <string>

#include "io/mesh/mesh_file.h"
#include "io/mesh/mesh_output.h"
#include "io/mesh/reading.h"

namespace oktett {

/// Reads `path`: positions, normals and texture coordinates of the element `vertex`, polygons of `face` and
/// strips of `tristrips`. Throws Error with the line, or the byte, for what the format does not allow, with
/// ErrorKind::io if the file cannot be read.
ParsedMesh parse_ply(const std::string& path, const MeshReadOptions& options = {});

/// Whether a comment of the header names Blender as the writer. Throws Error if the file cannot be read.
bool is_ply_of_blender(const std::string& path);

/// Writes positions, normals, texture coordinates and triangles: bytes in little-endian order, or text if
/// `ascii`. Returns what PLY cannot say. Throws Error of kind io if that fails.
MeshLosses write_ply(const std::string& path, const MeshFile& file, bool ascii);

}  // namespace oktett
