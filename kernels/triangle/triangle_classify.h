#pragma once
/// \file Classifies a ray and a triangle in float: surely missed, surely hit with t in bounds, or unclear.
/// A sure answer is one that `decide_watertight` would confirm, so a traversal need not call that at once.
/// The error bounds are derived in docs/numerics.md.

#include "kernels/triangle/triangle_watertight.h"

namespace oktett {

/// Bound on the rounding errors of the scaled weights in units of (size + shear)(reach) d_max: nine roundings
/// of 2^-24 and twice the error of the determinant.
inline constexpr float kWeightError = 0x1p-20f;
/// Bound on the rounding errors of the determinant and of t's numerator in units of (size + shear)^2: four
/// roundings of 2^-24 where the determinant's sign may be wrong.
inline constexpr float kVolumeError = 0x1p-21f;
/// How far the decision may displace a vertex, in units of the reach, relative to 2^-24; added to the size.
inline constexpr float kShearSize = 0x1p-24f;
/// Added to squares of lengths, so that a triangle whose products may underflow is never called sure.
inline constexpr float kUnderflowArea = 0x1p-80f;
/// Bound on the rounding of the quotient, of the interval's ends and of the decision's t to float.
inline constexpr float kQuotientError = 0x1p-21f;

/// The bounds hold if the greatest |component| of the direction is between the inverse of this and this ...
inline constexpr float kClassifyMaxDirection = 0x1p40f;
/// ... and if the ray's origin and the triangles lie within this distance from zero along each axis.
inline constexpr float kClassifyMaxExtent = 0x1p36f;

/// A ray against triangles in lanes, by Möller and Trumbore's scaled weights; all signs as if the
/// determinant were positive.
template <class F>
struct TriangleGuess {
  F least;   ///< least of the three weights
  F det, t;  ///< t * det is the distance
  F weight_error, det_error, t_error;
};

/// With d_max the greatest |component| of d, `weight_scale` = d_max * kWeightError and `det_scale` = d_max *
/// kVolumeError.
template <class F>
OKTETT_INLINE TriangleGuess<F> guess_triangle(const Vec3<F>& o, const Vec3<F>& d, const F& weight_scale,
                                              const F& det_scale, const FilterTriangle<F>& tri) {
  const Vec3<F> c = sub_lanes(tri.a, o);
  const Vec3<F> r = fast_cross(c, d);
  const F det = fast_dot(tri.n, d);
  const F u = flip_sign(fast_dot(r, tri.e2), det), v = -flip_sign(fast_dot(r, tri.e1), det);
  TriangleGuess<F> g;
  g.t = flip_sign(fast_dot(tri.n, c), det);
  g.det = abs(det);
  g.least = min(u, min(v, g.det - (u + v)));

  const F reach = norm1(c) + tri.size;
  const F size = fast_fma(F(kShearSize), reach, tri.size);
  const F area = fast_fma(size, size, F(kUnderflowArea)), strip = fast_fma(size, reach, F(kUnderflowArea));
  const F underflow(kFilterUnderflow);
  g.weight_error = fast_fma(strip, weight_scale, underflow);
  g.det_error = fast_fma(area, det_scale, underflow);
  g.t_error = fast_fma(area * reach, F(kVolumeError), underflow);
  return g;
}

/// Lanes that may be hit at 0 < t <= tmax.
template <class F>
OKTETT_INLINE typename F::M maybe_hit(const TriangleGuess<F>& g, const F& tmax) {
  const F beyond = fast_fma(tmax, g.det + g.det_error, g.t_error) - g.t;
  return F(0.0f) <= min(g.least + g.weight_error, min(g.t + g.t_error, beyond));
}

/// Triangles that are surely behind the ray's origin: its line meets them at t < 0 or not at all. A ray that
/// leaves a triangle begins so near to it that the bounds of TriangleGuess leave it open; this is computed in
/// double. The bounds are derived in docs/numerics.md.
template <int W, class A>
OKTETT_INLINE Mask<double, W, A> surely_behind(const Vec3<Simd<float, W, A>>& o,
                                               const Vec3<Simd<float, W, A>>& d,
                                               const TriangleLanes<Simd<float, W, A>>& tri) {
  using D = Simd<double, W, A>;
  const Vec3<D> a = to_double(tri.a), c = sub_lanes(a, to_double(o)), along = to_double(d);
  const Vec3<D> e1 = sub_lanes(to_double(tri.b), a), e2 = sub_lanes(to_double(tri.c), a);
  const Vec3<D> n = fast_cross(e1, e2);
  const D det = fast_dot(n, along), t = fast_dot(n, c), zero(0.0);
  const D reach = norm1(c) + norm1(e1) + norm1(e2);
  const auto magnitude = [](const Vec3<D>& v) { return Vec3<D>{abs(v.x), abs(v.y), abs(v.z)}; };
  const Vec3<D> p = magnitude(e1), q = magnitude(e2);
  // The components of n with all signs positive. det and t are rounded by less than 2^-50 of what they would
  // be with these, and with the magnitudes of d and c.
  const Vec3<D> m{p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x};
  const D det_error = D(0x1p-50) * fast_dot(m, magnitude(along));
  const D t_error = D(0x1p-48) * norm1(n) * reach + D(0x1p-50) * fast_dot(m, magnitude(c));
  return ((det_error < det) & (t < zero - t_error)) | ((det < zero - det_error) & (t_error < t));
}

/// `sure`: lanes that are hit at tmin < lo <= t <= hi <= tmax. lo and hi are defined only in these lanes.
template <class F>
struct HitInterval {
  F lo, hi;
  typename F::M sure;
};

template <class F>
OKTETT_INLINE HitInterval<F> hit_interval(const TriangleGuess<F>& g, const F& tmin, const F& tmax) {
  const F inverse = F(1.0f) / g.det;
  const F t = g.t * inverse;
  // Where all weights are above their errors, det is above three times its error. The factor 2 covers
  // dividing by a determinant that is too small by its error.
  const F radius = fast_fma(fast_fma(t, g.det_error, g.t_error), inverse + inverse, t * F(kQuotientError));
  HitInterval<F> h;
  h.lo = t - radius, h.hi = t + radius;
  h.sure = (g.least > g.weight_error) & (tmin < h.lo) & (h.hi <= tmax) & (h.hi <= F(3.402823466e38f));
  return h;
}

}  // namespace oktett
