#pragma once
/// \file Reading mesh files in two steps. Within io/ only.

#include <string>

#include "io/mesh/mesh_file.h"
#include "io/mesh/parsed_mesh.h"

namespace oktett {

/// What the mesh file `path` says by itself. Throws Error as load_mesh does.
ParsedMesh parse_mesh(const std::string& path);

/// Reads the files that `parsed` names, which comes from `path`.
MeshFile finish_mesh(const std::string& path, ParsedMesh parsed);

}  // namespace oktett
