#pragma once
/// \file What holds for every mesh that is read from a file.

#include "core/mesh.h"
#include "tests/fuzz/input.h"

namespace oktett::test {

inline void require_sound(const TriangleMesh& m) {
  require(m.indices.size() % 3 == 0, "three corners per triangle");
  for (const std::uint32_t i : m.indices) require(i < m.positions.size(), "corners exist");
  require(m.normal_indices.empty() || m.normal_indices.size() == m.indices.size(), "normals per corner");
  for (const std::uint32_t i : m.normal_indices) require(i == kNoId || i < m.normals.size(), "normals exist");
  require(m.uv_indices.empty() || m.uv_indices.size() == m.indices.size(), "uv per corner");
  for (const std::uint32_t i : m.uv_indices) require(i == kNoId || i < m.uvs.size(), "uv exist");
  require(m.tangents.empty() || m.tangents.size() == m.normals.size(), "a tangent for each normal");
  require(m.second_uvs.empty() || m.second_uvs.size() == m.uvs.size(), "second uv for each");
  require(m.material_slots.empty() || m.material_slots.size() == m.triangle_count(), "slots");
  for (const Vec3f& p : m.positions)
    require(p.x - p.x == 0 && p.y - p.y == 0 && p.z - p.z == 0, "positions are finite");
  for (const MeshAttribute& a : m.attributes) {
    require(a.components >= 1 && a.components <= 4 && !a.name.empty(), "attributes have one to four numbers");
    require(a.floats.size() + a.srgb.size() == domain_size(m, a.domain) * a.components,
            "values of attributes");
    require(a.floats.empty() || a.srgb.empty(), "one column of values");
    require(find_attribute(m, a.name) == &a, "names differ");
  }
  for (const Vec2f& uv : m.uvs)
    require(uv.x - uv.x == 0 && uv.y - uv.y == 0, "texture coordinates are finite");
}

}  // namespace oktett::test
