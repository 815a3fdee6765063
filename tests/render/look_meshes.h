#pragma once
/// \file Meshes for tests of how a mesh alone is shown.

#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/mesh.h"

namespace oktett::look_meshes {

inline void add_triangle(TriangleMesh& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  for (const Vec3f& p : {a, b, c}) {
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    mesh.positions.push_back(p);
  }
}

/// A box with shared vertices whose faces are seen from outside, or from inside.
inline void add_box(TriangleMesh& mesh, const Vec3f& lo, const Vec3f& hi, bool inward = false) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back({i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z});
  constexpr std::uint32_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& f : kFaces)
    for (const int k : {0, 1, 2, 0, 2, 3})
      mesh.indices.push_back(first + f[inward && k != 0 ? (k == 2 ? 2 : 4 - k) : k]);
}

/// Points on a sphere of radius 1, joined to triangles; vertices are shared.
inline TriangleMesh ball(int rows) {
  TriangleMesh mesh;
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j < 2 * rows; ++j) {
      const double a = std::numbers::pi * i / rows, b = std::numbers::pi * j / rows;
      mesh.positions.push_back(
          Vec3f(Vec3d{std::sin(a) * std::cos(b), std::cos(a), -std::sin(a) * std::sin(b)}));
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * 2 * rows + j % (2 * rows)); };
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < 2 * rows; ++j) {
      if (i > 0)
        for (const std::uint32_t v : {at(i, j), at(i + 1, j), at(i, j + 1)}) mesh.indices.push_back(v);
      if (i < rows - 1)
        for (const std::uint32_t v : {at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)})
          mesh.indices.push_back(v);
    }
  return mesh;
}

}  // namespace oktett::look_meshes
