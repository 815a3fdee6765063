#pragma once
/// \file Triangle meshes as data.

#include <cstdint>

#include "core/soa.h"
#include "core/vec3.h"

namespace oktett {

/// Marks an absent index or id everywhere in the project.
inline constexpr std::uint32_t kNoId = 0xffffffffu;

/// An indexed triangle mesh. `indices` holds three position indices per triangle. `normal_indices` and
/// `uv_indices` are each either empty (no triangle has any) or hold three indices per triangle, kNoId where a
/// corner has none. `material_slots` is either empty (all triangles use slot 0) or holds one slot per
/// triangle.
struct TriangleMesh {
  Column<Vec3f> positions;
  Column<Vec3f> normals;  ///< not necessarily of unit length
  Column<Vec2f> uvs;
  Column<std::uint32_t> indices;
  Column<std::uint32_t> normal_indices;
  Column<std::uint32_t> uv_indices;
  Column<std::uint16_t> material_slots;

  std::size_t triangle_count() const { return indices.size() / 3; }
  std::size_t bytes() const {
    return positions.bytes() + normals.bytes() + uvs.bytes() + indices.bytes() + normal_indices.bytes() +
           uv_indices.bytes() + material_slots.bytes();
  }
};

}  // namespace oktett
