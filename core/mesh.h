#pragma once
/// \file Triangle meshes as data.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/mesh_attributes.h"
#include "core/soa.h"
#include "core/vec3.h"

namespace oktett {

/// Marks an absent index or id everywhere in the project.
inline constexpr std::uint32_t kNoId = 0xffffffffu;

/// An indexed triangle mesh. The corners of a triangle run counter-clockwise seen from its front, the outside
/// of a closed mesh.
struct TriangleMesh {
  Column<Vec3f> positions;  ///< relative to `origin`
  Column<Vec3f> normals;    ///< of any length but zero
  Column<Vec2f> uvs;
  /// One for each of `normals`: a vector along the surface, and on which side of it, +1 or -1, the second
  /// axis of normal maps lies; zeros for none. Or empty: the axes are those of u and v.
  Column<std::array<float, 4>> tangents;
  Column<Vec2f> second_uvs;       ///< further texture coordinates, one for each of `uvs`; or empty
  Column<std::uint32_t> indices;  ///< three per triangle, into positions
  Column<std::uint32_t>
      normal_indices;                ///< three per triangle, kNoId for a corner without a normal; or empty
  Column<std::uint32_t> uv_indices;  ///< three per triangle, kNoId for a corner without uv; or empty
  Column<std::uint16_t> material_slots;   ///< one per triangle; or empty if all are in slot 0
  std::vector<MeshAttribute> attributes;  ///< of different names
  /// Where positions count from; not (0, 0, 0) for files that lie far from it, of which floats would lose
  /// details. Scenes take it as a translation; trees and queries know of positions alone.
  Vec3d origin{0, 0, 0};

  std::size_t triangle_count() const { return indices.size() / 3; }
  /// Memory of all columns.
  std::size_t bytes() const {
    std::size_t sum = positions.bytes() + normals.bytes() + uvs.bytes() + indices.bytes() +
                      normal_indices.bytes() + uv_indices.bytes() + material_slots.bytes() +
                      tangents.bytes() + second_uvs.bytes();
    for (const MeshAttribute& attribute : attributes) sum += attribute.bytes();
    return sum;
  }
};

/// The texture coordinates of the corners of a triangle: those of the mesh if all three have some, else
/// (0, 0), (1, 0) and (0, 1), so that u and v are the weights of the second and the third corner. `layer`: of
/// uvs, 0, or of second_uvs, 1.
inline std::array<Vec2f, 3> corner_uvs(const TriangleMesh& mesh, std::uint32_t triangle,
                                       std::uint8_t layer = 0) {
  std::array<Vec2f, 3> uv{{{0, 0}, {1, 0}, {0, 1}}};
  const Column<Vec2f>& uvs = layer == 0 ? mesh.uvs : mesh.second_uvs;
  if (mesh.uv_indices.empty() || uvs.empty()) return uv;
  const std::uint32_t* index = &mesh.uv_indices[3 * std::size_t{triangle}];
  if (index[0] != kNoId && index[1] != kNoId && index[2] != kNoId)
    for (std::size_t k = 0; k < 3; ++k) uv[k] = uvs[index[k]];
  return uv;
}

// ---- Attributes of meshes.

/// A place on a triangle of a mesh; u and v are the weights of its second and third corner.
struct MeshPoint {
  const TriangleMesh* mesh = nullptr;  ///< null: on no mesh
  std::uint32_t triangle = kNoId;
  float u = 0, v = 0;
};

/// How many values an attribute of this domain has.
std::size_t domain_size(const TriangleMesh& mesh, AttributeDomain domain);

/// The attribute of this name, or null.
const MeshAttribute* find_attribute(const TriangleMesh& mesh, std::string_view name);

/// Component `component` of the value at a corner, 0 to 2, of a triangle.
float corner_value(const TriangleMesh& mesh, const MeshAttribute& attribute, std::size_t triangle,
                   std::size_t corner, std::uint32_t component);

/// The value of an attribute of the mesh at a point of it: that of the triangle, or (1 - u - v) a + u b + v c
/// of those at its corners. The sum is computed in double and rounded to float: it differs from the exact one
/// by at most half a unit in the last place and 2^-50 of the greatest magnitude at a corner.
AttributeValue attribute_at(const MeshPoint& point, const MeshAttribute& attribute);

}  // namespace oktett
