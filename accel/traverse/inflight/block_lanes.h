#pragma once
/// \file One or two rays, each against its own block of triangles, side by side in lanes.

#include "accel/accel_data.h"
#include "core/lanes.h"
#include "kernels/triangle/triangle_classify.h"

namespace oktett {

/// Rays whose blocks are classified together.
template <class A>
inline constexpr int kBlockRays = std::is_same_v<A, Avx512Isa> ? 2 : 1;

/// The lanes of N blocks.
template <int N, class A>
using BlockLanes = Simd<float, N * TriangleBlock::kSize, A>;

/// vector(j), eight lanes, for j below N, side by side.
template <int N, class Function>
OKTETT_INLINE auto join_blocks(Function&& vector) {
  static_assert(N == 1 || N == 2);
  if constexpr (N == 1)
    return vector(0);
  else
    return concat(vector(0), vector(1));
}

/// number(j) in all lanes of block j.
template <int N, class A, class Function>
OKTETT_INLINE BlockLanes<N, A> spread_blocks(Function&& number) {
  return join_blocks<N>([&](int j) { return Simd<float, TriangleBlock::kSize, A>(number(j)); });
}

/// The triangles of block(j), for j below N, side by side.
template <int N, class A, class BlockOf>
OKTETT_INLINE TriangleLanes<BlockLanes<N, A>> load_blocks(BlockOf&& block) {
  if constexpr (N == 1) {
    return load_triangles<BlockLanes<N, A>>(block(0));
  } else {
    const TriangleBlock &a = block(0), &b = block(1);
    const PackedIndexPair<A> corners(a.corners, b.corners);
    const auto corner = [&](int k) {
      const auto axis = [&](int i) { return corners.look_up(k, a.point[i], b.point[i]); };
      return Vec3<BlockLanes<N, A>>{axis(0), axis(1), axis(2)};
    };
    return {corner(0), corner(1), corner(2)};
  }
}

/// Classifies the triangles of block(j) for ray(j), which has the members o, d, weight_scale and det_scale.
template <int N, class A, class RayOf, class BlockOf>
OKTETT_INLINE TriangleGuess<BlockLanes<N, A>> guess_blocks(RayOf&& ray, BlockOf&& block) {
  using F = BlockLanes<N, A>;
  const auto origin = [&](int k) { return spread_blocks<N, A>([&](int j) { return ray(j).o[k]; }); };
  const auto direction = [&](int k) { return spread_blocks<N, A>([&](int j) { return ray(j).d[k]; }); };
  return guess_triangle(Vec3<F>{origin(0), origin(1), origin(2)},
                        Vec3<F>{direction(0), direction(1), direction(2)},
                        spread_blocks<N, A>([&](int j) { return ray(j).weight_scale; }),
                        spread_blocks<N, A>([&](int j) { return ray(j).det_scale; }),
                        filter_triangle(load_blocks<N, A>(block)));
}

}  // namespace oktett
