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
OKTETT_INLINE void closed_surfaces(const typename S::Pool& pool, ShapeHits& hits) {
  for (std::size_t i = 0; i < hits.count; i += D::kWidth) {
    const HitPoints<D> hit(hits, i);
    const auto fetch = [&](const Column<double>& column) {
      double lanes[D::kWidth];
      for (int k = 0; k < D::kWidth; ++k) lanes[k] = column[hits.element[i + k]];
      return D::load(lanes);
    };
    const SurfacePoints<D> surface = S::surface(pool, fetch, hit);
    store_surface(hit, surface.point, surface.error, surface.normal, hits, i);
  }
}

/// Hits of one closed-form kind.
template <class A>
void closed_surfaces_code(const Accel& accel, Kind kind, ShapeHits& hits) {
  visit_pool(kind, accel.pools, [&](auto shape, const auto& pool) {
    closed_surfaces<decltype(shape), SurfaceLanes<A>>(pool, hits);
  });
}

}  // namespace oktett
