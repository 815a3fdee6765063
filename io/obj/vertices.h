#pragma once
/// \file The second pass over an OBJ file, first half: `v`, `vt` and `vn`.

#include "core/mesh.h"
#include "io/obj/chunk.h"

namespace oktett {

/// Reads the vertex data of a counted chunk to its place in `mesh`, whose columns have their final size.
/// Stops at the first failure in the chunk.
void read_vertices(ObjChunk& chunk, TriangleMesh& mesh);

}  // namespace oktett
