#pragma once
/// \file Rays in flight that wait at the same leaf of exact surfaces, tested together in lanes.

#include <algorithm>

#include "accel/exact.h"
#include "accel/traverse/inflight/inflight_ray.h"

namespace oktett {

/// Moves the rays that are at the same leaf as *begin next to it, at most as many as exact surfaces solve at
/// once, and returns how many there are with *begin; 0 if that is inside an instance or its leaf is of
/// another kind. `kInstances`: the rays may be inside instances; else their InflightRay::in is not set.
template <bool kInstances>
OKTETT_INLINE int rays_at_leaf(const Accel& accel, InflightRay** begin, InflightRay** end, int most) {
  const auto is_here = [&](const InflightRay& ray) {
    return (!kInstances || ray.in.instance == kNoInstance) && ray.current.bits() == (*begin)->current.bits();
  };
  if (!is_here(**begin) || !is_exact(accel.leaves[(*begin)->current.table_index()].kind)) return 0;
  int count = 1;
  for (InflightRay** at = begin + 1; at != end && count < most; ++at)
    if (is_here(**at)) std::swap(*at, begin[count++]);
  return count;
}

/// Tests `count` rays of a batch against the leaf where they are. Returns those that hit anything up to their
/// present end, as bits; `state` has the hits.
template <int N, class A>
OKTETT_INLINE unsigned meet_exact_leaf(const Accel& accel, const RaySpan& batch, InflightRay* const* rays,
                                       int count, RayState<N, A>& state) {
  using F = Simd<float, N, A>;
  // Lanes that are left over repeat the first ray.
  alignas(64) float column[8][N];
  for (int i = 0; i < N; ++i) {
    const InflightRay& ray = *rays[i < count ? i : 0];
    for (int k = 0; k < 3; ++k)
      column[k][i] = batch.origin[k][ray.index], column[3 + k][i] = batch.direction[k][ray.index];
    column[6][i] = batch.tmin[ray.index], column[7][i] = ray.tmax;
  }
  const auto load = [&](int k) { return F::load(column[k]); };
  unsigned lanes = (1u << count) - 1;
  lanes &= state.set_rays({load(0), load(1), load(2)}, {load(3), load(4), load(5)}, load(6), load(7));
  if (lanes != 0) leaf_exact(accel, accel.leaves[rays[0]->current.table_index()], state, lanes);
  return found_lanes(state, lanes);
}

}  // namespace oktett
