#pragma once
/// \file Surface points at hits, in lanes: what the formulas of all shapes share. Single hits use them with
/// one lane, so a hit gets the same bits alone and in a group.

#include <cmath>
#include <limits>
#include "core/lanes.h"
#include "core/ray.h"
#include "core/simd_memory.h"
#include "core/surface_interaction.h"
#include "core/vec3.h"

namespace oktett {

// ---- What shapes answer that are asked for their point nearest to a given one.

/// A point of a surface, as the nearest to another one. Where several points are nearest, such as all points
/// of a sphere to its centre, the choice follows from the numbers alone.
struct SurfaceNearest {
  double d2 = std::numeric_limits<double>::infinity();  ///< squared distance
  Vec3d point, normal;                                  ///< the normal has unit length and points outwards

  /// Takes `other` if it is nearer to p. Where two faces meet, that which faces p more counts, so that the
  /// side on which p lies follows from the normal.
  void keep_nearer(const Vec3d& p, const SurfaceNearest& other) {
    const auto facing = [&](const SurfaceNearest& s) { return std::abs(dot(p - s.point, s.normal)); };
    if (other.d2 < d2 || (other.d2 == d2 && facing(other) > facing(*this))) *this = other;
  }
  /// For a closed surface and whether p is `within` it: at edges the direction to p takes the place of a
  /// normal that does not tell on which side p is.
  void tell_side(const Vec3d& p, bool within) {
    const Vec3d away = p - point;
    const double size = length(away), facing = within ? -dot(away, normal) : dot(away, normal);
    if (size > 0 && facing < 0.5 * size) normal = away * ((within ? -1 : 1) / size);
  }
};

// ---- Surface points at hits, in lanes.

/// Hits in lanes, in double: rays and the distances at which they hit.
template <class D>
struct HitPoints {
  Vec3<D> o, d;
  D t;

  /// One hit in all lanes.
  OKTETT_INLINE HitPoints(const Ray& ray, double distance)
      : o(broadcast<D>(ray.origin)), d(broadcast<D>(ray.direction)), t(distance) {}
  /// The entries `at` of the columns `origin`, `direction` and `t` of `hits`.
  template <class Columns>
  OKTETT_INLINE HitPoints(const Columns& hits, const PickedLanes<Simd<float, D::kWidth, typename D::Isa>>& at)
      : o(load(hits.origin, at)), d(load(hits.direction, at)), t(to_double(at.load(hits.t))) {}

  OKTETT_INLINE Vec3<D> point() const { return add_lanes(o, scale_lanes(d, t)); }

 private:
  template <class F>
  OKTETT_INLINE static Vec3<D> load(const float* const (&column)[3], const PickedLanes<F>& at) {
    return to_double(Vec3<F>{at.load(column[0]), at.load(column[1]), at.load(column[2])});
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

/// SurfaceInteraction::position_error where `point`, rounded to float, is the position: an ulp of t along the
/// ray, the rounding of the point itself, and `surface_error`, by which `point` may be off the surface.
///
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

/// Writes positions, their errors and normals to the entries `at` of `out`, an InteractionBlock.
template <class D, class F, class Block>
OKTETT_INLINE void store_surface(const HitPoints<D>& hit, const SurfacePoints<D>& surface,
                                 const PickedLanes<F>& at, Block& out) {
  const auto store = [&](const Vec3<F>& v, auto& column) {
    at.store(v.x, column[0]), at.store(v.y, column[1]), at.store(v.z, column[2]);
  };
  store(to_float(surface.point), out.position);
  store(position_error(hit, surface.point, surface.error), out.position_error);
  const Vec3<F> normal = to_float(surface.normal);
  store(normal, out.geometric_normal), store(normal, out.shading_normal);
}

/// Position and error bound of a single hit: see position_error.
inline void set_position(SurfaceInteraction& s, const Vec3d& p, const Ray& ray, double t,
                         double surface_error) {
  using D = Simd<double, 1, ScalarIsa>;
  s.position = Vec3f(p);
  s.position_error = only_lane(position_error(HitPoints<D>(ray, t), broadcast<D>(p), D(surface_error)));
}

}  // namespace oktett
