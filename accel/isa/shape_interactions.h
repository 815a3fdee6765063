#pragma once
/// \file Surfaces of groups of hits of closed-form shapes, for one instruction set.

#include "accel/accel_data.h"
#include "accel/shape_hits.h"
#include "core/double_lanes.h"
#include "kernels/closed/surface_points.h"

namespace oktett {

/// Lanes for surfaces; one hit at a time without vector registers.
template <class A>
using SurfaceLanes = Simd<double, kDoubleLanes<A>, A>;

template <class S, class D>
OKTETT_INLINE void closed_surfaces(const typename S::Pool& pool, const ShapeHits& hits) {
  using F = Simd<float, D::kWidth, typename D::Isa>;
  for (std::size_t i = 0; i < hits.count; i += D::kWidth) {
    const HitPoints<D> hit(hits, PickedLanes<F>(hits.ray + i));
    const std::uint32_t* element = hits.element + i;
    bool same = true;
    for (int k = 1; k < D::kWidth; ++k) same &= element[k] == element[0];
    const auto fetch = [&](const Column<double>& column) {
      if (same) return D(column[element[0]]);
      double lanes[D::kWidth];
      for (int k = 0; k < D::kWidth; ++k) lanes[k] = column[element[k]];
      return D::load(lanes);
    };
    store_surface(hit, S::surface(pool, fetch, hit), PickedLanes<F>(hits.entry + i), *hits.out);
  }
}

/// Hits of one closed-form kind.
template <class A>
void closed_surfaces_code(const Accel& accel, Kind kind, const ShapeHits& hits) {
  visit_pool(kind, accel.pools, [&](auto shape, const auto& pool) {
    closed_surfaces<decltype(shape), SurfaceLanes<A>>(pool, hits);
  });
}

}  // namespace oktett
