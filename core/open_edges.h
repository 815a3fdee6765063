#pragma once
/// \file Whether a mesh is closed.

#include <cstdint>

#include "core/mesh.h"

namespace oktett {

/// Edges that triangles do not pass in both directions equally often.
struct OpenEdges {
  std::uint64_t count = 0;
  Vec3f from, to;  ///< the first of them, by the triangles' order
};

/// Vertices at the same position count as one, as files often repeat them. 0 for a closed mesh whose
/// triangles are wound alike.
OpenEdges find_open_edges(const TriangleMesh& mesh);

}  // namespace oktett
