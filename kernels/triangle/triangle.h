#pragma once
/// \file The triangles of meshes in leaves of the tree: blocks of eight, stored in columns.

#include <cstdint>

#include "core/lanes.h"
#include "kernels/triangle/triangle_tests.h"
#include "kernels/triangle/triangle_watertight.h"

namespace oktett {

/// Eight triangles: 320 bytes. `v[corner][axis][lane]`; unused lanes repeat a vertex three times, so no ray
/// hits them, and have the item kNoId.
struct alignas(64) TriangleBlock {
  static constexpr int kSize = 8;
  float v[3][3][kSize];
  std::uint32_t item[kSize];
};
static_assert(sizeof(TriangleBlock) == 320);

/// Triangle `lane` in all lanes of F, its axes permuted so that `z_axis` comes last (2 = as they are).
template <class F>
OKTETT_INLINE TriangleLanes<F> broadcast_triangle(const TriangleBlock& b, int lane, int z_axis = 2) {
  const auto corner = [&](int k) {
    return Vec3<F>{F(b.v[k][(z_axis + 1) % 3][lane]), F(b.v[k][(z_axis + 2) % 3][lane]),
                   F(b.v[k][z_axis][lane])};
  };
  return {corner(0), corner(1), corner(2)};
}

/// Triangles `first`, `first` + 1, ... in the lanes of F.
template <class F>
OKTETT_INLINE TriangleLanes<F> load_triangles(const TriangleBlock& b, int first = 0, int z_axis = 2) {
  const auto corner = [&](int k) {
    return Vec3<F>{F::load(&b.v[k][(z_axis + 1) % 3][first]), F::load(&b.v[k][(z_axis + 2) % 3][first]),
                   F::load(&b.v[k][z_axis][first])};
  };
  return {corner(0), corner(1), corner(2)};
}

}  // namespace oktett
