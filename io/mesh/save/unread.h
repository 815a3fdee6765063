#pragma once
/// \file What a mesh file says and its reader leaves aside. Within io/ only.

#include <cstddef>
#include <string>

#include "io/mesh/mesh_output.h"

namespace oktett {

/// Adds to `losses` what the OBJ, PLY or STL file `path`, whose reader made so many triangles, says beside
/// them: names of objects and groups, colours, polygons, digits beyond those of a float. Of colours in PLY
/// files the reader itself warns.
void note_unread(const std::string& path, std::size_t triangles, MeshLosses& losses);

}  // namespace oktett
