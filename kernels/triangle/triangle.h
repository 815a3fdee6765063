#pragma once
/// \file The textbook ray-triangle tests, in float: Möller-Trumbore, Badouel, Segura-Feito. They are fast and
/// simple, but neighbours may disagree about a shared edge. Each has a fixed order of operations, so its hits
/// have the same bits in every width and instruction set.

#include "core/lanes.h"
#include "kernels/triangle/triangle_watertight.h"

namespace oktett {

/// Möller and Trumbore, "Fast, Minimum Storage Ray-Triangle Intersection" (1997), both sides.
template <class F>
OKTETT_INLINE typename F::M moller_trumbore(const RayLanes<F>& ray, const TriangleLanes<F>& tri,
                                            HitLanes<F>& hit) {
  const F zero(0.0f), one(1.0f);
  const Vec3<F> e1 = sub_lanes(tri.b, tri.a), e2 = sub_lanes(tri.c, tri.a);
  const Vec3<F> p = cross_lanes(ray.d, e2);
  const F det = dot_lanes(e1, p);
  const F inv = one / det;
  const Vec3<F> s = sub_lanes(ray.o, tri.a);
  hit.u = dot_lanes(s, p) * inv;
  const Vec3<F> q = cross_lanes(s, e1);
  hit.v = dot_lanes(ray.d, q) * inv;
  hit.t = dot_lanes(e2, q) * inv;
  return ~(det == zero) & (hit.u >= zero) & (hit.v >= zero) & (hit.u + hit.v <= one) & (ray.tmin < hit.t) &
         (hit.t <= ray.tmax);
}

/// Badouel, "An Efficient Ray-Polygon Intersection" (Graphics Gems, 1990): the hit point on the plane, then
/// barycentric coordinates of its projection along the normal's dominant axis. Projection keeps the ratios of
/// areas.
template <class F>
OKTETT_INLINE typename F::M badouel(const RayLanes<F>& ray, const TriangleLanes<F>& tri, HitLanes<F>& hit) {
  const F zero(0.0f), one(1.0f);
  const Vec3<F> e1 = sub_lanes(tri.b, tri.a), e2 = sub_lanes(tri.c, tri.a);
  const Vec3<F> n = cross_lanes(e1, e2);
  const F det = dot_lanes(n, ray.d);
  const Vec3<F> s = sub_lanes(tri.a, ray.o);
  hit.t = dot_lanes(n, s) / det;
  const Vec3<F> p{hit.t * ray.d.x - s.x, hit.t * ray.d.y - s.y, hit.t * ray.d.z - s.z};
  const F nx = abs(n.x), ny = abs(n.y), nz = abs(n.z);
  const auto use_x = (nx >= ny) & (nx >= nz);
  const auto use_y = ~use_x & (ny >= nz);
  // The two axes that remain, in cyclic order so that the area keeps the sign of the normal's component.
  const auto pick = [&](const F& if_x, const F& if_y, const F& if_z) {
    return select(use_x, if_x, select(use_y, if_y, if_z));
  };
  const F p1 = pick(p.y, p.z, p.x), p2 = pick(p.z, p.x, p.y);
  const F a1 = pick(e1.y, e1.z, e1.x), a2 = pick(e1.z, e1.x, e1.y);
  const F b1 = pick(e2.y, e2.z, e2.x), b2 = pick(e2.z, e2.x, e2.y);
  const F area = one / pick(n.x, n.y, n.z);
  hit.u = (p1 * b2 - p2 * b1) * area;
  hit.v = (a1 * p2 - a2 * p1) * area;
  return ~(det == zero) & (hit.u >= zero) & (hit.v >= zero) & (hit.u + hit.v <= one) & (ray.tmin < hit.t) &
         (hit.t <= ray.tmax);
}

/// Segura and Feito, "Algorithms to Test Ray-Triangle Intersection" (2001): the ray's line passes the
/// triangle if the signed volumes of the tetrahedra over its edges agree. Made for rays that need no hit
/// point: u, v and t come from the same volumes and are computed here so that all tests share one contract.
template <class F>
OKTETT_INLINE typename F::M segura_feito(const RayLanes<F>& ray, const TriangleLanes<F>& tri,
                                         HitLanes<F>& hit) {
  const F zero(0.0f);
  const Vec3<F> a = sub_lanes(tri.a, ray.o), b = sub_lanes(tri.b, ray.o), c = sub_lanes(tri.c, ray.o);
  const F wa = dot_lanes(ray.d, cross_lanes(c, b));
  const F wb = dot_lanes(ray.d, cross_lanes(a, c));
  const F wc = dot_lanes(ray.d, cross_lanes(b, a));
  const auto inside =
      ((wa >= zero) & (wb >= zero) & (wc >= zero)) | ((wa <= zero) & (wb <= zero) & (wc <= zero));
  const F sum = (wa + wb) + wc;
  const F volume = -dot_lanes(a, cross_lanes(b, c));
  hit.t = volume / sum;
  hit.u = wb / sum;
  hit.v = wc / sum;
  return inside & ~(sum == zero) & (ray.tmin < hit.t) & (hit.t <= ray.tmax);
}

}  // namespace oktett
