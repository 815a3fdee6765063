#pragma once
/// \file Rays in flight that wait at the same leaf of shapes, tested together in lanes.

#include <algorithm>
#include <limits>

#include "accel/traverse/inflight/inflight_ray.h"
#include "accel/traverse/packet.h"

namespace oktett {

/// Rays of a group at a leaf of closed-form shapes or combinations.
inline constexpr int kGroupRays = 16;

/// The least number of rays at a leaf that are tested faster together, with a ray in each lane, than one by
/// one, with a shape in each lane. Greater than kGroupRays if there is none.
inline int least_group(const LeafEntry& leaf) {
  // A ray that is alone at a combination or a polygon uses one lane.
  if (leaf.kind == Kind::polygon || leaf.kind == Kind::csg) return 3;
  // Alone, each ray takes one step for up to eight shapes. Together, sixteen take two steps for each shape.
  if (is_closed_form(leaf.kind)) return 2 * leaf.count + 1;
  return std::numeric_limits<int>::max();
}

/// Moves the rays that are at the same leaf as *begin next to it, and returns how many there are with *begin,
/// at most `most`; 0 if that is inside an instance. `kInstances`: the rays may be inside instances; else
/// their InflightRay::in is not set.
template <bool kInstances>
OKTETT_INLINE int rays_at_leaf(InflightRay** begin, InflightRay** end, int most) {
  const auto is_here = [&](const InflightRay& ray) {
    return (!kInstances || ray.in.instance == kNoInstance) && ray.current.bits() == (*begin)->current.bits();
  };
  if (!is_here(**begin)) return 0;
  int count = 1;
  for (InflightRay** at = begin + 1; at != end && count < most; ++at)
    if (is_here(**at)) std::swap(*at, begin[count++]);
  return count;
}

/// `count` rays of a batch side by side, up to their present ends. Lanes that are left over repeat the first.
template <int N, class A>
OKTETT_INLINE RayLanes<Simd<float, N, A>> gather_rays(const RaySpan& batch, InflightRay* const* rays,
                                                      int count) {
  using F = Simd<float, N, A>;
  alignas(64) float column[8][N];
  for (int i = 0; i < N; ++i) {
    const InflightRay& ray = *rays[i < count ? i : 0];
    for (int k = 0; k < 3; ++k)
      column[k][i] = batch.origin[k][ray.index], column[3 + k][i] = batch.direction[k][ray.index];
    column[6][i] = batch.tmin[ray.index], column[7][i] = ray.tmax;
  }
  const auto load = [&](int k) { return F::load(column[k]); };
  return {{load(0), load(1), load(2)}, {load(3), load(4), load(5)}, load(6), load(7)};
}

}  // namespace oktett
