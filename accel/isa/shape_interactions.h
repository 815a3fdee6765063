#pragma once
/// \file Surfaces of groups of hits of closed-form shapes, for one instruction set.

#include "accel/accel_data.h"
#include "accel/code.h"
#include "core/double_lanes.h"
#include "kernels/closed/surface_points.h"

namespace oktett {

/// Lanes for surfaces; one hit at a time without vector registers.
template <class A>
using SurfaceLanes = Simd<double, kDoubleLanes<A>, A>;

/// Stores the points on the surface of hits i, i + 1, ...
template <class D>
OKTETT_INLINE void store_points(const Vec3<D>& points, std::size_t i, ShapeHits& hits) {
  points.x.store(hits.point[0] + i), points.y.store(hits.point[1] + i), points.z.store(hits.point[2] + i);
}

template <class S, class D>
OKTETT_INLINE void closed_surfaces(const typename S::Pool& pool, ShapeHits& hits) {
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
    const PickedLanes<F> entry(hits.entry + i);
    const SurfacePoints<D> at = S::surface(pool, fetch, hit);
    store_surface(hit, at, entry, *hits.out);
    if (!hits.with_uv) continue;
    if constexpr (kHasUvLanes<S>) {
      D u, v;
      S::uv_lanes(at.normal, u, v);
      entry.store(to_float(u), hits.out->uv[0]), entry.store(to_float(v), hits.out->uv[1]);
    } else {
      store_points(at.point, i, hits);
    }
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
