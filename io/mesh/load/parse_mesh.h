#pragma once
/// \file Reading mesh files in two steps: parse_mesh, then finish_mesh. Within io/ only.

#include <string>

#include "io/mesh/reading.h"
#include "io/obj/parsed_obj.h"

namespace oktett {

/// Whether files of the format of `path` are read in two steps: not those of glTF, whose numbers stand in the
/// file as they are in memory, and of 3MF, which a library reads.
bool can_parse_mesh(const std::string& path);

/// What the mesh file `path` says by itself. Throws Error as load_mesh does.
ParsedMesh parse_mesh(const std::string& path);

}  // namespace oktett
