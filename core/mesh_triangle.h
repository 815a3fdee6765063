#pragma once
/// \file Single triangles of a mesh, in double.

#include "core/mesh.h"

namespace oktett {

/// Corner `k` of a triangle, 0 to 2.
inline Vec3d corner(const TriangleMesh& mesh, std::size_t triangle, std::size_t k) {
  return Vec3d(mesh.positions[mesh.indices[3 * triangle + k]]);
}

/// The normal of a triangle, twice as long as its area; it points to the front.
inline Vec3d area_normal(const TriangleMesh& mesh, std::size_t triangle) {
  const Vec3d a = corner(mesh, triangle, 0);
  return cross(corner(mesh, triangle, 1) - a, corner(mesh, triangle, 2) - a);
}

}  // namespace oktett
