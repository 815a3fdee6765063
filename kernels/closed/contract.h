#pragma once
/// \file What a closed-form shape is to the tracer, and how its roots become hits.
///
/// A shape S (one file each) has
/// - `S::Pool`: columns of double, one element per primitive, plus `item` numbers; `S::add` appends,
///   `S::finish` pads with primitives that can never be hit, so that lanes may be loaded past the end;
/// - `S::Lanes<D>`, `S::load<D>(pool, i)`: primitives i, i+1, ... in lanes; `S::broadcast<D>(pool, i)`: one
///   in all lanes;
/// - `S::kRoots` and `S::roots(ray, lanes, t)`: where the ray's whole line meets the shape, t[0] <= t[1], and
///   a mask of the lanes where it does. In double, with a fixed order of operations: everywhere the same
///   bits;
/// - `S::bounds(pool, i)` (not for unbounded shapes) and `S::interaction(pool, i, ray, t)`; where uv costs
/// much,
///   also `S::interaction_without_uv(pool, i, ray, t)`, the same without uv and tangent;
/// - `S::kSolid`: has an inside; then `S::inside(pool, i, point)`.

#include "core/box.h"
#include "core/lanes.h"
#include "core/ray.h"
#include "core/soa.h"
#include "core/surface_interaction.h"

namespace oktett {

/// Lanes that a pool must be readable past its last element.
inline constexpr int kPoolPadding = 16;

/// Takes the first root of each lane inside (tmin, tmax] as the hit. Distances are compared after rounding to
/// float, which is how they are stored, so that the choice does not depend on who asks.
template <class S, int W, class A>
OKTETT_INLINE Mask<float, W, A> first_root(const RayLanes<Simd<float, W, A>>& ray,
                                           const RayLanes<Simd<double, W, A>>& ray_d,
                                           const typename S::template Lanes<Simd<double, W, A>>& shape,
                                           HitLanes<Simd<float, W, A>>& hit) {
  using F = Simd<float, W, A>;
  using D = Simd<double, W, A>;
  D t[S::kRoots];
  const auto meets = mask_cast<float>(S::roots(ray_d, shape, t));
  const F far_limit = min(ray.tmax, F(3.402823466e38f));
  auto found = meets & ~meets;
  hit.t = F(0.0f);
  for (int k = S::kRoots - 1; k >= 0; --k) {
    const F tk = to_float(t[k]);
    const auto valid = meets & (ray.tmin < tk) & (tk <= far_limit);
    hit.t = select(valid, tk, hit.t);
    found = found | valid;
  }
  hit.u = hit.v = F(0.0f);
  return found;
}

/// The point at distance t and a bound on its error: half an ulp of t along the ray, the rounding of the
/// point itself to float, and `surface_error`, the shape's own uncertainty.
inline void set_position(SurfaceInteraction& s, const Vec3d& p, const Ray& ray, double t,
                         double surface_error) {
  s.position = Vec3f(p);
  const double ulp = 0x1p-23;
  for (int k = 0; k < 3; ++k)
    s.position_error[k] =
        round_up(ulp * std::abs(t * ray.direction[k]) + ulp * std::abs(p[k]) + surface_error + 1e-37);
}

/// origin + t * direction in double.
inline Vec3d point_at(const Ray& ray, double t) { return Vec3d(ray.origin) + Vec3d(ray.direction) * t; }

}  // namespace oktett
