#pragma once
/// \file The second pass over an OBJ file, second half: `f`.

#include "core/mesh.h"
#include "io/obj/chunk.h"

namespace oktett {

struct ObjFaceOptions {
  /// Whether the positions are all there, so that polygons can be cut properly. If not, faces are only
  /// checked.
  bool positions_known = true;
};

/// Reads the faces of a counted chunk to their place in the index columns of `mesh`, which have their final
/// size (those of normals and uvs may be empty if the file has none). Stops at the first failure in the
/// chunk.
void read_faces(ObjChunk& chunk, const ObjCounts& total, TriangleMesh& mesh, const ObjFaceOptions& options);

}  // namespace oktett
