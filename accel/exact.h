#pragma once
/// \file Leaves of exact surfaces.

#include "accel/exact_table.h"
#include "accel/ray_state.h"

namespace oktett {

/// The rays in `lanes` of a state against the cells of a leaf.
template <int W, class A>
OKTETT_NOINLINE void leaf_exact(const Accel& accel, const LeafEntry& leaf, RayState<W, A>& r,
                                unsigned lanes) {
  constexpr int N = ExactCode<A>::kLanes;
  using F = typename ExactCode<A>::F;
  const ExactPoolBase& pool = accel.exact_pool(leaf.kind);
  const auto first = exact_code<A>(leaf.kind).first;
  for (std::uint32_t cell = leaf.begin; cell < leaf.begin + leaf.count; ++cell) {
    for (int base = 0; base < W; base += N) {
      const unsigned part = lanes >> base & ((1u << N) - 1);
      if (part == 0) continue;
      // Lanes past the end of a narrow state repeat its first one.
      const auto load = [&](const float* column) {
        if constexpr (N <= W) return F::load(column + base);
        float padded[N];
        for (int i = 0; i < N; ++i) padded[i] = column[i < W ? i : 0];
        return F::load(padded);
      };
      const RayLanes<F> rays{{load(r.o[0]), load(r.o[1]), load(r.o[2])},
                             {load(r.d[0]), load(r.d[1]), load(r.d[2])},
                             load(r.tmin),
                             load(r.tmax)};
      HitLanes<F> hits;
      unsigned met = first(pool, cell, rays, part, hits);
      if (met == 0) continue;
      const std::uint32_t item = pool.item_of_cell(cell);
      float t[N], u[N], v[N];
      hits.t.store(t), hits.u.store(u), hits.v.store(v);
      for (; met != 0; met &= met - 1) {
        const int i = __builtin_ctz(met);
        accept_hit(r, base + i, t[i], u[i], v[i], item, kNoId);
      }
    }
  }
}

}  // namespace oktett
