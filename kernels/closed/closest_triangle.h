#pragma once
/// \file The point of a triangle that is nearest to another point, in lanes of double: the same bits in every
/// width and instruction set.
///
/// The nearest points of the three edges are always computed, and that of the face if it is inside. The least
/// distance counts. So a triangle that is nearly a line, whose normal is all rounding error, still gives a
/// point of its own at the right distance (the usual choice of one region by signs, e.g. Ericson: Real-Time
/// Collision Detection, section 5.1.5, does not).

#include "core/lanes.h"

namespace oktett {

/// The nearest point of an edge: lo + t (hi - lo).
template <class D>
struct ClosestOnEdge {
  D d2;  ///< squared distance
  D t;
};

/// The point of the edge a, b that is nearest to p; t counts from a. The edge is evaluated from the end that
/// comes first by x, then y, then z, so triangles that share it find the same distance.
template <class D>
OKTETT_INLINE ClosestOnEdge<D> closest_on_edge(const Vec3<D>& p, const Vec3<D>& a, const Vec3<D>& b) {
  const auto swapped = (b.x < a.x) | ((b.x == a.x) & ((b.y < a.y) | ((b.y == a.y) & (b.z < a.z))));
  const Vec3<D> lo = select_lanes(swapped, b, a), hi = select_lanes(swapped, a, b);
  const Vec3<D> e = sub_lanes(hi, lo), f = sub_lanes(p, lo);
  const D t = dot_lanes(f, e) / dot_lanes(e, e);
  const D zero(0.0), one(1.0);
  // False if the ends coincide and t is NaN: then the first end counts.
  const auto between = (zero < t) & (t < one), behind = one <= t;
  const D clamped = select(between, t, select(behind, one, zero));
  // The ends themselves are not computed, so that all triangles around a corner agree on its distance.
  const Vec3<D> away = select_lanes(behind, sub_lanes(p, hi), f);
  const Vec3<D> r = select_lanes(between, sub_lanes(f, scale_lanes(e, t)), away);
  return {dot_lanes(r, r), select(swapped, one - clamped, clamped)};
}

/// The nearest point of a triangle.
template <class D>
struct ClosestOnTriangle {
  D d2;    ///< squared distance
  D u, v;  ///< weights of the second and the third corner
};

template <class D>
OKTETT_INLINE ClosestOnTriangle<D> closest_on_triangle(const Vec3<D>& p, const Vec3<D>& a, const Vec3<D>& b,
                                                       const Vec3<D>& c) {
  const ClosestOnEdge<D> ab = closest_on_edge(p, a, b), bc = closest_on_edge(p, b, c),
                         ca = closest_on_edge(p, c, a);
  const D zero(0.0), one(1.0);
  ClosestOnTriangle<D> best{ab.d2, ab.t, zero};
  const auto take = [&](const typename D::M& where, const D& d2, const D& u, const D& v) {
    best = {select(where, d2, best.d2), select(where, u, best.u), select(where, v, best.v)};
  };
  take(bc.d2 < best.d2, bc.d2, one - bc.t, bc.t);
  take(ca.d2 < best.d2, ca.d2, zero, one - ca.t);
  // The foot of the perpendicular. Cross products with the normal keep the error of the weights linear in the
  // ratio of the longest edge to the height.
  const Vec3<D> e1 = sub_lanes(b, a), e2 = sub_lanes(c, a), f = sub_lanes(p, a);
  const Vec3<D> n = cross_lanes(e1, e2);
  const D inverse = one / dot_lanes(n, n);
  const D u = dot_lanes(n, cross_lanes(f, e2)) * inverse, v = dot_lanes(n, cross_lanes(e1, f)) * inverse;
  const Vec3<D> r = sub_lanes(f, add_lanes(scale_lanes(e1, u), scale_lanes(e2, v)));
  const D d2 = dot_lanes(r, r);
  take((zero < u) & (zero < v) & (u + v < one) & (d2 < best.d2), d2, u, v);
  return best;
}

}  // namespace oktett
