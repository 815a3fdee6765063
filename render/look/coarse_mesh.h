#pragma once
/// \file A coarse copy of a mesh of many triangles, to look at it as a whole.

#include "core/mesh.h"

namespace oktett {

/// What is left of a mesh if the vertices in each cell of a grid become the first of them, by
/// Rossignac and Borrel, "Multi-resolution 3D approximations for rendering complex scenes" (1993). The
/// longest edge of the box has `cells` cells, at most 1024. Positions and indices only; triangles of which
/// two corners lie in one cell are left out, as are those that are not finite. The same mesh for any number
/// of threads.
TriangleMesh coarse_copy(const TriangleMesh& mesh, int cells);

}  // namespace oktett
