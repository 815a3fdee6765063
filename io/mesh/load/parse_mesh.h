#pragma once
/// \file Reading mesh files in two steps. Within io/ only.

#include <string>

#include "io/mesh/mesh_file.h"
#include "io/mesh/parsed_mesh.h"

namespace oktett {

/// Whether files of the format of `path` are read in two steps: not those of glTF, whose numbers stand in the
/// file as they are in memory.
bool can_parse_mesh(const std::string& path);

/// What the mesh file `path` says by itself. Throws Error as load_mesh does.
ParsedMesh parse_mesh(const std::string& path);

/// Reads the files that `parsed` names, which comes from `path`.
MeshFile finish_mesh(const std::string& path, ParsedMesh parsed);

}  // namespace oktett
