#pragma once
/// \file The watertight ray-triangle test: Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection"
/// (JCGT 2(1), 2013), made exact.
///
/// The vertices are moved to the ray's origin and sheared so that the ray becomes the z axis; the triangle is
/// hit if the origin of the xy plane lies inside its projection. Departures from the paper:
/// - The shear is done in double, so a vertex is displaced by some 2^-52 of its distance instead of 2^-23.
/// - The signs of the three edge functions are exact for the sheared vertices. Two products are compared; if
///   they round to the same number, their rounding errors are compared.
/// - The weights are corrected by the same errors, so t, u and v are accurate on slivers seen edge-on.
/// - If an edge function is exactly zero, the query point is moved by (e, e^2) with infinitesimal e. Hence
///   each point of the plane belongs to exactly one of the triangles around an edge or vertex.
///
/// So a ray crosses a closed mesh exactly once at an edge or vertex.
///
/// A sheared vertex depends on the ray and the vertex alone, so neighbours agree about it and no gap can
/// open.
///
/// `filter_*` reject most triangles in float and never one that `decide_watertight` would accept; see
/// docs/numerics.md.

#include "core/lanes.h"

namespace oktett {

/// A ray prepared for the decision. The axis of greatest |d| becomes z, the next two in cyclic order x and y.
/// `inv_dz` = 1/dz, `shear_x` = dx * inv_dz and `shear_y` = dy * inv_dz in double.
template <class D>
struct ShearLanes {
  Vec3<D> o;  ///< permuted
  D inv_dz, shear_x, shear_y;
};

template <class F>
struct TriangleLanes {
  Vec3<F> a, b, c;
};

/// (x, y, z) -> (x, y, z) permuted so that `axis` comes last.
template <class F>
OKTETT_INLINE Vec3<F> permute_to_z(const Vec3<F>& v, int axis) {
  return axis == 2 ? v : axis == 0 ? Vec3<F>{v.y, v.z, v.x} : Vec3<F>{v.z, v.x, v.y};
}

/// An edge function p x q in the sheared plane: its value, and its sign after the tie rule.
template <class D>
struct EdgeFunction {
  D value;
  typename D::M positive, negative;
};

/// p x q = px * qy - py * qx, the weight of the corner opposite the edge from p to q (Woop et al. 2013).
template <class D>
OKTETT_INLINE EdgeFunction<D> edge_function(const D& px, const D& py, const D& qx, const D& qy) {
  const D m = px * qy, n = py * qx;
  const D em = product_error(px, qy, m), en = product_error(py, qx, n);
  EdgeFunction<D> e;
  e.value = (m - n) + (em - en);
  const auto equal = m == n;
  e.positive = (m > n) | (equal & (em > en));
  e.negative = (m < n) | (equal & (em < en));
  const auto tie = equal & (em == en);
  if (OKTETT_UNLIKELY(any(tie))) {
    const auto same_y = py == qy;
    e.positive = e.positive | (tie & ((py > qy) | (same_y & (px < qx))));
    e.negative = e.negative | (tie & ((py < qy) | (same_y & (px > qx))));
  }
  return e;
}

/// The decision, bit-identical in every width and instruction set. `tri` is permuted like the ray. Lanes must
/// hold finite numbers. u and v are the weights of b and c. `clockwise` is defined in lanes that are hit: the
/// displaced corners run clockwise around the sheared axis. A line crosses a closed mesh, so displaced,
/// equally often either way.
template <int W, class A>
OKTETT_INLINE Mask<float, W, A> decide_watertight(const ShearLanes<Simd<double, W, A>>& ray,
                                                  const TriangleLanes<Simd<float, W, A>>& tri,
                                                  const Simd<float, W, A>& tmin,
                                                  const Simd<float, W, A>& tmax,
                                                  HitLanes<Simd<float, W, A>>& hit,
                                                  Mask<float, W, A>& clockwise) {
  using F = Simd<float, W, A>;
  using D = Simd<double, W, A>;
  const Vec3<D> a = sub_lanes(to_double(tri.a), ray.o);
  const Vec3<D> b = sub_lanes(to_double(tri.b), ray.o);
  const Vec3<D> c = sub_lanes(to_double(tri.c), ray.o);
  const D ax = a.x - ray.shear_x * a.z, ay = a.y - ray.shear_y * a.z;
  const D bx = b.x - ray.shear_x * b.z, by = b.y - ray.shear_y * b.z;
  const D cx = c.x - ray.shear_x * c.z, cy = c.y - ray.shear_y * c.z;

  const EdgeFunction<D> u = edge_function(cx, cy, bx, by);
  const EdgeFunction<D> v = edge_function(ax, ay, cx, cy);
  const EdgeFunction<D> w = edge_function(bx, by, ax, ay);
  const auto inside = (u.positive & v.positive & w.positive) | (u.negative & v.negative & w.negative);
  clockwise = mask_cast<float>(u.positive);
  if (none(inside)) return mask_cast<float>(inside);

  // One division for all three quotients; each result is within two roundings of 2^-53 of its quotient.
  const D inv_det = D(1.0) / ((u.value + v.value) + w.value);
  const D t = (((u.value * a.z + v.value * b.z) + w.value * c.z) * inv_det) * ray.inv_dz;
  hit.t = to_float(t);
  // Adding zero turns -0 into 0: the sign of a zero weight depends on how its rounding error was found.
  hit.u = to_float(v.value * inv_det) + F(0.0f);
  hit.v = to_float(w.value * inv_det) + F(0.0f);
  return mask_cast<float>(inside) & (tmin < hit.t) & (hit.t <= tmax) & (hit.t <= F(3.402823466e38f));
}

template <int W, class A>
OKTETT_INLINE Mask<float, W, A> decide_watertight(const ShearLanes<Simd<double, W, A>>& ray,
                                                  const TriangleLanes<Simd<float, W, A>>& tri,
                                                  const Simd<float, W, A>& tmin,
                                                  const Simd<float, W, A>& tmax,
                                                  HitLanes<Simd<float, W, A>>& hit) {
  Mask<float, W, A> clockwise;
  return decide_watertight(ray, tri, tmin, tmax, hit, clockwise);
}

/// A triangle prepared for the filter: its edges from a, their cross product and their size.
template <class F>
struct FilterTriangle {
  Vec3<F> a, e1, e2, n;
  F size;  ///< |e1|_1 + |e2|_1
};

template <class F>
OKTETT_INLINE FilterTriangle<F> filter_triangle(const TriangleLanes<F>& t) {
  FilterTriangle<F> f;
  f.a = t.a, f.e1 = sub_lanes(t.b, t.a), f.e2 = sub_lanes(t.c, t.a);
  f.n = fast_cross(f.e1, f.e2);
  f.size = norm1(f.e1) + norm1(f.e2);
  return f;
}

/// Rounding errors of the filter in units of the products' magnitudes: about 16 roundings of 2^-24, and a
/// factor for a determinant whose sign is in doubt.
inline constexpr float kFilterError = 0x1p-18f;
/// How far the decision may displace a vertex, in units of its distance and relative to kFilterError. Matters
/// if a triangle is tiny compared with its distance.
inline constexpr float kFilterShear = 0x1p-30f;
/// Covers products that underflow.
inline constexpr float kFilterUnderflow = 1e-37f;
/// A direction with a greater component may make products overflow that the error bound does not contain.
inline constexpr float kFilterMaxDirection = 0x1p60f;

/// Lanes that `decide_watertight` might accept, from the scaled barycentric coordinates u, v, the determinant
/// and the scaled distance (as in Möller and Trumbore 1997, but with either sign of det). Keeps lanes with
/// NaN or overflow: the sum that contains all three weights is the accumulator of the minimum.
template <class F>
OKTETT_INLINE typename F::M filter_decide(const F& det, const F& u, const F& v, const F& t, const F& error,
                                          const F& t_error, const F& tmax) {
  using M = typename F::M;
  const F det_abs = abs(det);
  const F us = flip_sign(u, det), vs = flip_sign(v, det), ts = flip_sign(t, det);
  const F least = min(us, min(vs, det_abs - (us + vs)));
  const M reject = (least < -error) | (ts < -t_error) | (ts > fast_fma(tmax, det_abs + error, t_error));
  return ~reject;
}

/// Bounds on the errors of u, v, det and t. `c` is the vector from the ray's origin to the triangle's first
/// corner. `d_max` = greatest |component| of the ray's direction, infinity if that is above
/// kFilterMaxDirection.
///
/// `magnitude` is twice a bound on every partial sum of the products. So an overflow in one of them makes the
/// error infinite, which keeps the lane.
template <class F>
OKTETT_INLINE void filter_error(const Vec3<F>& c, const F& triangle_size, const F& d_max, F& error,
                                F& t_error) {
  const F reach = norm1(c) + triangle_size;
  const F size = fast_fma(F(kFilterShear), reach, triangle_size);
  const F magnitude = fast_fma(size, reach + reach, F(kFilterUnderflow));
  error = fast_fma(magnitude * d_max, F(kFilterError / 2), F(kFilterUnderflow));
  t_error = fast_fma(magnitude * reach, F(kFilterError / 2), F(kFilterUnderflow));
}

/// The filter for any lanes; `d_max` as in filter_error.
template <class F>
OKTETT_INLINE typename F::M filter_watertight(const RayLanes<F>& ray, const F& d_max,
                                              const FilterTriangle<F>& tri) {
  const Vec3<F> c = sub_lanes(tri.a, ray.o);
  const Vec3<F> r = fast_cross(c, ray.d);
  const F det = fast_dot(tri.n, ray.d);
  const F u = fast_dot(r, tri.e2), v = -fast_dot(r, tri.e1), t = fast_dot(tri.n, c);
  F error, t_error;
  filter_error(c, tri.size, d_max, error, t_error);
  return filter_decide(det, u, v, t, error, t_error, ray.tmax);
}

/// For rays from one point `o` and triangles in lanes: u, v, det and t as linear functions of the rays'
/// direction.
template <class F>
struct OriginTriangle {
  Vec3<F> u, v, det;
  F t, error, t_error;
};

/// `d_max` covers all rays.
template <class F>
OKTETT_INLINE OriginTriangle<F> origin_triangle(const FilterTriangle<F>& tri, const Vec3<F>& o,
                                                const F& d_max) {
  const Vec3<F> c = sub_lanes(tri.a, o);
  OriginTriangle<F> r;
  r.u = fast_cross(tri.e2, c), r.v = fast_cross(c, tri.e1), r.det = tri.n;
  r.t = fast_dot(tri.n, c);
  filter_error(c, tri.size, d_max, r.error, r.t_error);
  return r;
}

/// The filter for rays from the point that `tri` was made for.
template <class F>
OKTETT_INLINE typename F::M filter_watertight(const Vec3<F>& d, const F& tmax, const OriginTriangle<F>& tri) {
  return filter_decide(fast_dot(tri.det, d), fast_dot(tri.u, d), fast_dot(tri.v, d), tri.t, tri.error,
                       tri.t_error, tmax);
}

}  // namespace oktett
