#pragma once
/// \file The triangles of meshes in leaves of the tree: blocks of eight with their corners.

#include <cstdint>

#include "core/lanes.h"
#include "core/simd_memory.h"
#include "kernels/triangle/triangle_tests.h"
#include "kernels/triangle/triangle_watertight.h"

namespace oktett {

/// Up to eight triangles and the up to sixteen corners that they share: 256 bytes. Unused lanes have the same
/// corner three times, so no ray hits them, and the item kNoId.
struct alignas(64) TriangleBlock {
  static constexpr int kSize = 8, kCorners = 16;
  float point[3][kCorners];      ///< the corners, [axis][number]; unused ones repeat number 0
  std::uint16_t corners[kSize];  ///< of each triangle: the number of corner k in the bits from 4 k on
  std::uint32_t item[kSize];
  std::uint32_t padding[4];

  /// The number of corner `k` of triangle `lane`.
  int corner(int k, int lane) const { return corners[lane] >> 4 * k & 15; }
  Vec3f vertex(int k, int lane) const {
    const int n = corner(k, lane);
    return {point[0][n], point[1][n], point[2][n]};
  }
};
static_assert(sizeof(TriangleBlock) == 256);

/// Triangle `lane` in all lanes of F, its axes permuted so that `z_axis` comes last (2 = as they are).
template <class F>
OKTETT_INLINE TriangleLanes<F> broadcast_triangle(const TriangleBlock& b, int lane, int z_axis = 2) {
  const auto corner = [&](int k) {
    const int n = b.corner(k, lane);
    return Vec3<F>{F(b.point[(z_axis + 1) % 3][n]), F(b.point[(z_axis + 2) % 3][n]), F(b.point[z_axis][n])};
  };
  return {corner(0), corner(1), corner(2)};
}

/// Triangles `first`, `first` + 1, ... in the lanes of F.
template <class F>
OKTETT_INLINE TriangleLanes<F> load_triangles(const TriangleBlock& b, int first = 0, int z_axis = 2) {
  const PackedIndices<F::kWidth, typename F::Isa> corners(b.corners + first);
  const auto corner = [&](int k) {
    const auto axis = [&](int a) { return corners.look_up(k, b.point[a]); };
    return Vec3<F>{axis((z_axis + 1) % 3), axis((z_axis + 2) % 3), axis(z_axis)};
  };
  return {corner(0), corner(1), corner(2)};
}

}  // namespace oktett
