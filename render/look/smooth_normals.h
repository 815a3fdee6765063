#pragma once
/// \file Normals for meshes whose file has none.

#include "core/mesh.h"

namespace oktett {

/// Sets the normal of each corner of each triangle to the mean, by area, of the normals of the triangles that
/// share its vertex and whose normals are at most `crease` degrees apart from that of the triangle.
void add_smooth_normals(TriangleMesh& mesh, double crease);

}  // namespace oktett
