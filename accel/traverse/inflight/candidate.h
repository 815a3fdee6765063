#pragma once
/// \file The candidate hit of a ray whose triangles are classified in float: the nearest triangle that is
/// surely hit, which is decided when the ray is finished.

#include "accel/ray_state.h"
#include "kernels/triangle/triangle_classify.h"

namespace oktett {

/// A candidate is block * TriangleBlock::kSize + lane, or one of these: nothing has been hit so far, or the
/// nearest hit so far is decided and stands in the ray's RayState.
inline constexpr std::uint32_t kNoCandidate = 0xffffffffu;
inline constexpr std::uint32_t kDecidedHit = 0xfffffffeu;

/// The item of the nearest hit so far, if it is a triangle of a tree with `blocks`, else kNoId. `path` is the
/// path of hits in that tree. `r` is read only if the candidate is kDecidedHit.
template <class A>
OKTETT_INLINE std::uint32_t candidate_item(const TriangleBlock* blocks, std::uint32_t candidate,
                                           const RayState<1, A>& r, std::uint32_t path) {
  constexpr std::uint32_t kBlock = TriangleBlock::kSize;
  if (candidate < kDecidedHit) return blocks[candidate / kBlock].item[candidate % kBlock];
  return candidate == kDecidedHit && r.path[0] == path ? r.item[0] : kNoId;
}

/// The lane of `block`, as a bit, that holds the triangle `item`, if there is one. A triangle that was split
/// stands in several leaves, and need not be tested again if it is the nearest hit so far.
template <class A>
OKTETT_INLINE unsigned repeated_lane(std::uint32_t item, const TriangleBlock& block) {
  constexpr int kBlock = TriangleBlock::kSize;
  using I = Simd<std::int32_t, kBlock, A>;
  const auto* items = reinterpret_cast<const std::int32_t*>(block.item);
  return item == kNoId ? 0 : bits(I::load(items) == I(static_cast<std::int32_t>(item)));
}

/// The triangles of `block` that are surely behind the origin `o` of a ray, as bits.
template <class A>
OKTETT_NOINLINE unsigned behind_origin(const float* o, const float* d, const TriangleBlock& block) {
  using F = Simd<float, TriangleBlock::kSize, A>;
  return bits(surely_behind(Vec3<F>{F(o[0]), F(o[1]), F(o[2])}, Vec3<F>{F(d[0]), F(d[1]), F(d[2])},
                            load_triangles<F>(block)));
}

/// A triangle that is surely hit at lo <= t <= hi.
struct SureHit {
  int lane;
  float lo, hi;
};

/// Of the triangles in `sure`, not empty, the one with the least hi. Bit 0 of `sure` is lane `first` of `h`.
template <class F>
OKTETT_INLINE SureHit nearest_sure(const HitInterval<F>& h, unsigned sure, int first) {
  alignas(64) float lo[F::kWidth], hi[F::kWidth];
  h.lo.store(lo), h.hi.store(hi);
  int nearest = __builtin_ctz(sure);
  for (unsigned rest = sure & (sure - 1); rest != 0; rest &= rest - 1)
    if (hi[first + __builtin_ctz(rest)] < hi[first + nearest]) nearest = __builtin_ctz(rest);
  return {nearest, lo[first + nearest], hi[first + nearest]};
}

}  // namespace oktett
