#pragma once
/// \file Corners, normals and open edges of the triangles of a mesh.

#include <cstdint>

#include "core/box.h"
#include "core/mesh.h"

namespace oktett {

/// Corner `k` of a triangle, 0 to 2.
inline Vec3d corner(const TriangleMesh& mesh, std::size_t triangle, std::size_t k) {
  return Vec3d(mesh.positions[mesh.indices[3 * triangle + k]]);
}

/// Calls f(position) for the corners of all triangles; files may hold vertices that none has.
template <class F>
void each_corner(const TriangleMesh& mesh, F&& f) {
  for (const std::uint32_t i : mesh.indices) f(mesh.positions[i]);
}

/// The box of the corners of all triangles.
inline Box corner_box(const TriangleMesh& mesh) {
  Box box;
  each_corner(mesh, [&](const Vec3f& p) { box.grow(p); });
  return box;
}

/// The normal of a triangle, twice as long as its area; it points to the front.
inline Vec3d area_normal(const TriangleMesh& mesh, std::size_t triangle) {
  const Vec3d a = corner(mesh, triangle, 0);
  return cross(corner(mesh, triangle, 1) - a, corner(mesh, triangle, 2) - a);
}

/// Edges that the triangles do not traverse equally often in both directions.
struct OpenEdges {
  std::uint64_t count = 0;
  Vec3f from, to;  ///< the first such edge, in the order of the triangles
};

/// Vertices at the same position count as one, since files often repeat them. 0 for a closed mesh whose
/// triangles have consistent winding.
OpenEdges find_open_edges(const TriangleMesh& mesh);

}  // namespace oktett
