#pragma once
/// \file The code of one exact shape for one instruction set: defined in exact_code.h, compiled family by
/// family in exact_*.cpp.

#include "accel/crossing_lanes.h"
#include "accel/hit_list.h"
#include "accel/ray_state.h"
#include "accel/shape_hits.h"
#include "core/double_lanes.h"
#include "kernels/exact_shapes.h"

namespace oktett {

/// The operations of ExactCode (accel/exact.h) on a pool of shapes S.
template <class S, class A>
struct ExactShapeCode {
  using F = Simd<float, kDoubleLanes<A>, A>;
  using Pool = typename S::Pool;

  static unsigned first(const Pool& pool, std::uint32_t cell, const RayLanes<F>& rays, unsigned lanes,
                        HitLanes<F>& hits);
  static void all(const Pool& pool, std::uint32_t cell, const Ray& ray,
                  HitList& hits) requires std::is_same_v<A, ScalarIsa>;
  static void rows(const Pool& pool, std::uint32_t cell, const RayLanes<F>& rays, unsigned lanes,
                   CrossingLanes<F::kWidth>& out);
  static bool surfaces(const Pool& pool, ShapeHits& hits);
};

}  // namespace oktett
