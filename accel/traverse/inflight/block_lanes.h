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

/// Classifies the triangles of block(j) for ray(j), which has the members o, d, weight_scale and det_scale.
template <int N, class A, class RayOf, class BlockOf>
OKTETT_INLINE TriangleGuess<BlockLanes<N, A>> guess_blocks(RayOf&& ray, BlockOf&& block) {
  using F = BlockLanes<N, A>;
  const auto corners = [&] {
    if constexpr (N == 1)
      return PackedIndices<TriangleBlock::kSize, A>(block(0).corners);
    else
      return PackedIndexPair<A>(block(0).corners, block(1).corners);
  }();
  const auto corner = [&](int k) {
    const auto axis = [&](int a) {
      if constexpr (N == 1)
        return corners.look_up(k, block(0).point[a]);
      else
        return corners.look_up(k, block(0).point[a], block(1).point[a]);
    };
    return Vec3<F>{axis(0), axis(1), axis(2)};
  };
  const auto origin = [&](int k) { return spread_blocks<N, A>([&](int j) { return ray(j).o[k]; }); };
  const auto direction = [&](int k) { return spread_blocks<N, A>([&](int j) { return ray(j).d[k]; }); };
  return guess_triangle(Vec3<F>{origin(0), origin(1), origin(2)},
                        Vec3<F>{direction(0), direction(1), direction(2)},
                        spread_blocks<N, A>([&](int j) { return ray(j).weight_scale; }),
                        spread_blocks<N, A>([&](int j) { return ray(j).det_scale; }),
                        filter_triangle(TriangleLanes<F>{corner(0), corner(1), corner(2)}));
}

}  // namespace oktett
