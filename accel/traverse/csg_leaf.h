#pragma once
/// \file Rays against Boolean combinations: gathers the crossings with all solids, sweeps them, takes the
/// first.

#include "accel/csg/csg.h"
#include "accel/traverse/csg_lanes.h"

namespace oktett {

template <class A>
void collect(const Accel& accel, const RayState<1, A>& r, HitList& hits);

/// Appends all crossings of a ray with the solids of a combination, from tmin to infinity: crossings beyond
/// tmax also tell whether the ray begins inside a solid. False for a ray that can hit nothing.
template <class A>
OKTETT_NOINLINE bool gather_solids(const CsgItem& csg, const Ray& ray, HitList& crossings) {
  RayState<1, A> state;
  if (state.set({ray.origin, ray.tmin, ray.direction, std::numeric_limits<float>::infinity()},
                csg.solids->bounds) == 0)
    return false;
  collect(*csg.solids, state, crossings);
  return true;
}

/// The rays in `lanes` against a combination, one by one.
template <int W, class A>
OKTETT_NOINLINE void csg_singly(const CsgItem& csg, RayState<W, A>& r, unsigned lanes) {
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    const Ray ray{{r.o[0][i], r.o[1][i], r.o[2][i]}, r.tmin[i], {r.d[0][i], r.d[1][i], r.d[2][i]}, r.tmax[i]};
    CsgSweep sweep;
    Crossing found;
    if (gather_solids<A>(csg, ray, sweep.solids()) && sweep.first(csg, ray, found))
      accept_hit(r, i, found.hit.t, found.hit.u, found.hit.v, found.hit.item, found.hit.instance);
  }
}

/// The rays in `lanes` of the CsgLanes<A>::N rays from `base` on against a combination, at once.
template <int W, class A>
OKTETT_NOINLINE void csg_together(const CsgItem& csg, RayState<W, A>& r, int base, unsigned lanes) {
  CsgLanes<A> packet(csg, r, base, lanes);
  typename CsgLanes<A>::Found found;
  if (!packet.first(found)) return csg_singly(csg, r, lanes << base);
  const auto& rows = packet.rows();
  for (unsigned rest = found.lanes; rest != 0; rest &= rest - 1) {
    const int i = __builtin_ctz(rest), row = found.row[i];
    accept_hit(r, base + i, found.t[i], rows.part[row][i], rows.exact[row] ? rows.turn[row][i] : 0.0f,
               rows.item[row], csg_path(csg, kNoId, (found.flipped >> i & 1) != 0));
  }
}

/// The rays in `lanes` against the combinations of a leaf.
template <int W, class A>
OKTETT_NOINLINE void leaf_csg(const Accel& accel, const LeafEntry& leaf, RayState<W, A>& r, unsigned lanes) {
  constexpr int N = CsgLanes<A>::N;
  for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k) {
    const CsgItem& csg = accel.combinations[k];
    if (!csg.in_lanes) {
      csg_singly(csg, r, lanes);
      continue;
    }
    for (int base = 0; base < W; base += N) {
      const unsigned part = lanes >> base & ((2u << (N - 1)) - 1);
      if (part != 0) csg_together(csg, r, base, part);
    }
  }
}

/// Appends every crossing of a ray with a combination.
template <class A>
OKTETT_NOINLINE void collect_csg(const CsgItem& csg, const Ray& ray, HitList& hits) {
  CsgSweep sweep;
  if (gather_solids<A>(csg, ray, sweep.solids())) sweep.all(csg, ray, hits);
}

}  // namespace oktett
