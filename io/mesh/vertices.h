#pragma once
/// \file Vertices at the same place; and meshes for formats in which a vertex has one position, one normal
/// and one texture coordinate. Within io/ only.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh.h"
#include "io/mesh/mesh_output.h"

namespace oktett {

/// Makes one of all positions that are equal, -0 as 0. The first of each place is kept, in the order of the
/// mesh. Attributes of vertices at one place that differ become those of corners.
void weld_positions(TriangleMesh& mesh);

struct UnifiedMesh {
  std::vector<Vec3f> positions;  ///< relative to `origin`
  Vec3d origin{0, 0, 0};
  std::vector<Vec3f> normals;                  ///< one for each position; empty if no triangle has normals
  std::vector<Vec2f> uvs;                      ///< likewise
  std::vector<std::array<float, 4>> tangents;  ///< likewise; zeros where there are none
  std::vector<Vec2f> second_uvs;               ///< likewise
  std::vector<std::uint32_t> indices;
  std::vector<MeshAttribute> attributes;  ///< of vertices, and of faces unless these are split, too
  std::size_t split = 0;                  ///< vertices behind those of the mesh, which repeat positions
  std::size_t flat = 0;  ///< triangles without normals in a mesh that has some; theirs are the geometric ones

  /// What is changed, for the losses of the file.
  void note_changes(std::size_t before, MeshLosses& losses) const;
};

/// The vertices of `mesh` keep their numbers. A position that is shown with several normals, texture
/// coordinates or values of an attribute is repeated at the end for each further one. Triangles without
/// texture coordinates in a mesh that has some get those of corner_uvs. Attributes of faces become those of
/// vertices, too, unless `keep_faces`.
UnifiedMesh unify_vertices(const TriangleMesh& mesh, bool keep_faces = false);

/// Of length 1, to the front of the triangle; zero for a degenerate one.
Vec3f flat_normal(const Vec3f& a, const Vec3f& b, const Vec3f& c);

}  // namespace oktett
