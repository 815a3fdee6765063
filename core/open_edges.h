#pragma once
/// \file Open edges: checks whether a mesh is closed.

#include <cstdint>

#include "core/mesh.h"

namespace oktett {

/// Edges that the triangles do not traverse equally often in both directions.
struct OpenEdges {
  std::uint64_t count = 0;
  Vec3f from, to;  ///< the first such edge, in the order of the triangles
};

/// Vertices at the same position count as one, since files often repeat them. 0 for a closed mesh whose
/// triangles have consistent winding.
OpenEdges find_open_edges(const TriangleMesh& mesh);

}  // namespace oktett
