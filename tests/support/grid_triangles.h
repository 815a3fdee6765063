#pragma once
/// \file Triangles over a grid of vertices.

#include <cstdint>

#include "core/mesh.h"

namespace oktett {

/// Adds two triangles for each cell of n x n, whose (n + 1)^2 vertices `mesh` holds row by row.
inline void add_grid_triangles(TriangleMesh& mesh, std::uint32_t n) {
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = (n + 1) * y + x, b = a + n + 1;
      for (const std::uint32_t corner : {a, a + 1, b, b, a + 1, b + 1}) mesh.indices.push_back(corner);
    }
}

}  // namespace oktett
