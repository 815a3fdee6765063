#pragma once
/// \file Surface points at hits, in lanes: what the formulas of all shapes share. Single hits use them with
/// one lane, so a hit gets the same bits alone and in a group.

#include "core/affine_lanes.h"
#include "core/ray.h"
#include "core/surface_interaction.h"

namespace oktett {

/// Hits in lanes, in double: rays and the distances at which they hit.
template <class D>
struct HitPoints {
  Vec3<D> o, d;
  D t;

  /// One hit in all lanes.
  OKTETT_INLINE HitPoints(const Ray& ray, double distance)
      : o(broadcast<D>(ray.origin)), d(broadcast<D>(ray.direction)), t(distance) {}
  /// Hits i, i + 1, ... of the columns `origin`, `direction` and `t` of `hits`.
  template <class Columns>
  OKTETT_INLINE HitPoints(const Columns& hits, std::size_t i)
      : o(load(hits.origin, i)), d(load(hits.direction, i)), t(to_double(F::load(hits.t + i))) {}

  OKTETT_INLINE Vec3<D> point() const { return add_lanes(o, scale_lanes(d, t)); }

 private:
  using F = Simd<float, D::kWidth, typename D::Isa>;
  template <class Column>
  OKTETT_INLINE static Vec3<D> load(const Column& column, std::size_t i) {
    return to_double(Vec3<F>{F::load(column[0] + i), F::load(column[1] + i), F::load(column[2] + i)});
  }
};

/// The surface at hits, as a shape's formula gives it.
template <class D>
struct SurfacePoints {
  Vec3<D> point;   ///< moved onto the surface
  D error;         ///< bound on the distance from `point` to the surface, per component
  Vec3<D> normal;  ///< of unit length
};

/// round_up of core/box.h in lanes, for x >= 1e-37 or NaN.
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> round_up_lanes(const Simd<double, W, A>& x) {
  using F = Simd<float, W, A>;
  const F nearest = to_float(x);
  // Adding five to ten eighths of the distance to the next float rounds to that float.
  const F next = nearest + nearest * F(0.625f * 0x1p-23f);
  return select(mask_cast<float>(to_double(nearest) < x), next, nearest);
}

/// Bound on |position - true hit point| per component where `point`, rounded to float, is the position: half
/// an ulp of t along the ray, the rounding of the point itself, and `surface_error`, the shape's own
/// uncertainty.
template <int W, class A>
OKTETT_INLINE Vec3<Simd<float, W, A>> position_error(const HitPoints<Simd<double, W, A>>& hit,
                                                     const Vec3<Simd<double, W, A>>& point,
                                                     const Simd<double, W, A>& surface_error) {
  using D = Simd<double, W, A>;
  const D ulp(0x1p-23);
  const auto error = [&](const D& direction, const D& place) {
    return round_up_lanes(ulp * abs(hit.t * direction) + ulp * abs(place) + surface_error + D(1e-37));
  };
  return {error(hit.d.x, point.x), error(hit.d.y, point.y), error(hit.d.z, point.z)};
}

/// Writes positions, their errors and normals to entries i, i + 1, ... of the columns `position`,
/// `position_error` and `normal` of `out`.
template <class D, class Columns>
OKTETT_INLINE void store_surface(const HitPoints<D>& hit, const Vec3<D>& point, const D& surface_error,
                                 const Vec3<D>& normal, Columns& out, std::size_t i) {
  const auto store = [&](const auto& v, auto& column) {
    v.x.store(column[0] + i), v.y.store(column[1] + i), v.z.store(column[2] + i);
  };
  store(to_float(point), out.position);
  store(position_error(hit, point, surface_error), out.position_error);
  store(to_float(normal), out.normal);
}

/// Position and error bound of a single hit: see position_error.
inline void set_position(SurfaceInteraction& s, const Vec3d& p, const Ray& ray, double t,
                         double surface_error) {
  using D = Simd<double, 1, ScalarIsa>;
  s.position = Vec3f(p);
  s.position_error = only_lane(position_error(HitPoints<D>(ray, t), broadcast<D>(p), D(surface_error)));
}

}  // namespace oktett
