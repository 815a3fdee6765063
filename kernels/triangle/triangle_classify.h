#pragma once
/// \file What float arithmetic can tell about a ray and a triangle: surely missed, surely hit with t within
/// bounds, or unclear. "Surely" is about `decide_watertight`: whatever is called sure it would confirm, so a
/// traversal may put its decision off. The error bounds are derived in docs/numerics.md.

#include "kernels/triangle/triangle_watertight.h"

namespace oktett {

/// In units of (size + shear)(reach) d_max: rounding errors of the scaled weights, 9 of 2^-24 and twice the
/// determinant's.
inline constexpr float kWeightError = 0x1p-20f;
/// In units of (size + shear)^2: rounding errors of the determinant and of t's numerator, 4 of 2^-24 where
/// the determinant's sign may be wrong.
inline constexpr float kVolumeError = 0x1p-21f;
/// In units of the reach, added to the size: what the decision may displace a vertex, relative to 2^-24.
inline constexpr float kShearSize = 0x1p-24f;
/// Added to squares of lengths: a triangle so small that its products may underflow is never called sure.
inline constexpr float kUnderflowArea = 0x1p-80f;
/// Rounding of the quotient, of the interval's ends and of the decision's t to float.
inline constexpr float kQuotientError = 0x1p-21f;

/// The bounds hold for rays with a greatest |direction component| between the inverse of this and this ...
inline constexpr float kClassifyMaxDirection = 0x1p40f;
/// ... whose origin lies, like the triangles, within this distance from zero, along each axis.
inline constexpr float kClassifyMaxExtent = 0x1p36f;

/// A ray against triangles in lanes, by Möller and Trumbore's scaled weights; all signs as if the
/// determinant were positive.
template <class F>
struct TriangleGuess {
  F least;   ///< of the three weights
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

/// `sure`: lanes that are hit at tmin < lo <= t <= hi <= tmax. The bounds are defined there alone.
template <class F>
struct HitInterval {
  F lo, hi;
  typename F::M sure;
};

template <class F>
OKTETT_INLINE HitInterval<F> hit_interval(const TriangleGuess<F>& g, const F& tmin, const F& tmax) {
  const F inverse = F(1.0f) / g.det;
  const F t = g.t * inverse;
  // Where all weights are above their errors, det is above three of its own: the factor 2 covers dividing
  // by a determinant that is too small by one.
  const F radius = fast_fma(fast_fma(t, g.det_error, g.t_error), inverse + inverse, t * F(kQuotientError));
  HitInterval<F> h;
  h.lo = t - radius, h.hi = t + radius;
  h.sure = (g.least > g.weight_error) & (tmin < h.lo) & (h.hi <= tmax) & (h.hi <= F(3.402823466e38f));
  return h;
}

}  // namespace oktett
