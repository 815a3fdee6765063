#pragma once
/// \file How much a function can vary in a box: a range of its values with bounds on its first and second
/// derivatives there, and on the rounding errors of computing them at a point of the box (second-order
/// forward differentiation with absolute values; docs/interval.md).
///
/// All bounds but the range are sums and products of non-negative numbers, computed without rounding upwards:
/// whoever uses them adds 2^-20 of their size.

#include <cmath>

#include "core/lanes.h"
#include "kernels/functions/noise_lanes.h"
#include "kernels/interval/dual.h"

namespace oktett {

/// `doubt` is NaN unless the function is proved to have derivatives in the whole box, apart from kinks.
template <class D>
struct Variation {
  Interval<D> v;   ///< encloses all values
  D error;         ///< bounds that of a value in plain arithmetic; the interval of a point is no wider
  Vec3<D> g;       ///< bounds on the absolute derivatives by x, y and z
  D slope_error;   ///< of a computed derivative along a unit direction
  D h[6];          ///< bounds on the absolute second derivatives by xx, yy, zz, xy, xz, yz
  D falls, rises;  ///< infinite where a kink may make the slope fall or rise, else 0
  D doubt;         ///< 0 or NaN
};

namespace variation {

/// Bound on the relative rounding errors of one operation, in plain arithmetic and by intervals.
inline constexpr double kUnit = 0x1p-49;
/// The same for the slope of a function of one number; real powers have the greatest.
inline constexpr double kSlope = 0x1p-36;
/// Absolute errors of sine and cosine, and of inverse trigonometric functions.
inline constexpr double kSine = 0x1p-48, kArc = 0x1p-44;

template <class D>
OKTETT_INLINE D magnitude(const Interval<D>& v) {
  return max(abs(v.lo), abs(v.hi));
}
template <class D>
OKTETT_INLINE D total(const Vec3<D>& g) {
  return (g.x + g.y) + g.z;
}
/// x where `defined`, NaN elsewhere.
template <class D>
OKTETT_INLINE D or_nan(const typename D::M& defined, const D& x) {
  return oktett::select(defined, x, D(std::numeric_limits<double>::quiet_NaN()));
}
/// The range of values, wider by four times their rounding error.
template <class D>
OKTETT_INLINE Interval<D> wide(const Variation<D>& a) {
  return {a.v.lo - D(4.0) * a.error, a.v.hi + D(4.0) * a.error};
}
/// Adds `by` (a_i b_j + a_j b_i) to h for each pair of axes i, j, in the order of Variation::h.
template <class D>
OKTETT_INLINE void add_products(const D& by, const Vec3<D>& a, const Vec3<D>& b, D (&h)[6]) {
  h[0] = h[0] + D(2.0) * by * (a.x * b.x), h[1] = h[1] + D(2.0) * by * (a.y * b.y);
  h[2] = h[2] + D(2.0) * by * (a.z * b.z), h[3] = h[3] + by * (a.x * b.y + a.y * b.x);
  h[4] = h[4] + by * (a.x * b.z + a.z * b.x), h[5] = h[5] + by * (a.y * b.z + a.z * b.y);
}
template <class D>
OKTETT_INLINE Variation<D> constant(const D& c) {
  const D zero(0.0);
  return {Interval<D>(c), zero, {zero, zero, zero}, zero, {zero, zero, zero, zero, zero, zero}, zero,
          zero,           zero};
}
/// f(a), where |f'| is at most `slope`, |f''| at most `bend`, and f itself is computed with an absolute error
/// of at most `own`. What a kink of `a` becomes depends on the sign of f'.
template <class D>
OKTETT_INLINE Variation<D> chain(const Variation<D>& a, const Interval<D>& v, const D& slope, const D& bend,
                                 const D& own, const typename D::M& rising, const typename D::M& falling) {
  Variation<D> r;
  r.v = v, r.error = slope * a.error + own;
  r.g = {slope * a.g.x, slope * a.g.y, slope * a.g.z};
  r.slope_error = slope * a.slope_error + (bend * a.error + D(kSlope) * slope) * total(a.g);
  for (int k = 0; k < 6; ++k) r.h[k] = slope * a.h[k];
  add_products(bend * D(0.5), a.g, a.g, r.h);
  const D both = a.falls + a.rises;
  r.falls = select(rising, a.falls, select(falling, a.rises, both));
  r.rises = select(rising, a.rises, select(falling, a.falls, both));
  r.doubt = a.doubt + (slope - slope) + (bend - bend) + (own - own);
  return r;
}
/// The same for functions that rise everywhere or, if not `rising`, fall everywhere.
template <class D>
OKTETT_INLINE Variation<D> chain_monotone(const Variation<D>& a, const Interval<D>& v, const D& slope,
                                          const D& bend, const D& own, bool rising = true) {
  const auto all = D::M::all_true();
  return chain(a, v, slope, bend, own, rising ? all : ~all, rising ? ~all : all);
}
template <class D>
OKTETT_INLINE Variation<D> select(const typename D::M& m, const Variation<D>& a, const Variation<D>& b) {
  Variation<D> r;
  r.v = oktett::select(m, a.v, b.v), r.error = oktett::select(m, a.error, b.error);
  r.g = select_lanes(m, a.g, b.g), r.slope_error = oktett::select(m, a.slope_error, b.slope_error);
  for (int k = 0; k < 6; ++k) r.h[k] = oktett::select(m, a.h[k], b.h[k]);
  r.falls = oktett::select(m, a.falls, b.falls), r.rises = oktett::select(m, a.rises, b.rises);
  r.doubt = oktett::select(m, a.doubt, b.doubt);
  return r;
}
/// Bounds that hold for both `a` and `b`; the range of values is that of `a`.
template <class D>
OKTETT_INLINE Variation<D> either(const Variation<D>& a, const Variation<D>& b) {
  Variation<D> r;
  r.v = a.v, r.error = max(a.error, b.error);
  r.g = {max(a.g.x, b.g.x), max(a.g.y, b.g.y), max(a.g.z, b.g.z)};
  r.slope_error = max(a.slope_error, b.slope_error);
  for (int k = 0; k < 6; ++k) r.h[k] = max(a.h[k], b.h[k]);
  r.falls = max(a.falls, b.falls), r.rises = max(a.rises, b.rises);
  r.doubt = a.doubt + b.doubt;
  return r;
}
/// A step function of `a`: constant if its values at both ends, `from` and `to`, are equal. Otherwise nothing
/// is known of it.
template <class D>
OKTETT_INLINE Variation<D> stepped(const Variation<D>& a, const D& from, const D& to) {
  Variation<D> r = constant(from);
  r.v = interval::carry(a.v, {from, to});
  r.doubt = a.doubt + or_nan(from == to, D(0.0));
  return r;
}

}  // namespace variation

template <class D>
OKTETT_INLINE void set(Variation<D>& r, double c) {
  r = variation::constant(D(c));
}
template <class D>
OKTETT_INLINE Variation<D> operator-(const Variation<D>& a) {
  Variation<D> r = a;
  r.v = -a.v, r.falls = a.rises, r.rises = a.falls;
  return r;
}
template <class D>
OKTETT_NOINLINE Variation<D> operator+(const Variation<D>& a, const Variation<D>& b) {
  Variation<D> r;
  r.v = a.v + b.v, r.error = (a.error + b.error) + D(variation::kUnit) * variation::magnitude(r.v);
  r.g = add_lanes(a.g, b.g);
  r.slope_error = (a.slope_error + b.slope_error) + D(variation::kUnit) * variation::total(r.g);
  for (int k = 0; k < 6; ++k) r.h[k] = a.h[k] + b.h[k];
  r.falls = a.falls + b.falls, r.rises = a.rises + b.rises, r.doubt = a.doubt + b.doubt;
  return r;
}
template <class D>
OKTETT_INLINE Variation<D> operator-(const Variation<D>& a, const Variation<D>& b) {
  return a + -b;
}
template <class D>
OKTETT_NOINLINE Variation<D> operator*(const Variation<D>& a, const Variation<D>& b) {
  const D at_a = variation::magnitude(a.v) + a.error, at_b = variation::magnitude(b.v) + b.error;
  const D sum_a = variation::total(a.g), sum_b = variation::total(b.g), unit(variation::kUnit);
  Variation<D> r;
  r.v = a.v * b.v;
  r.error = (at_a * b.error + at_b * a.error) + unit * (at_a * at_b);
  r.g = add_lanes(scale_lanes(b.g, at_a), scale_lanes(a.g, at_b));
  r.slope_error = (at_a * b.slope_error + at_b * a.slope_error) + (a.error * sum_b + b.error * sum_a) +
                  unit * variation::total(r.g);
  for (int k = 0; k < 6; ++k) r.h[k] = at_a * b.h[k] + at_b * a.h[k];
  variation::add_products(D(1.0), a.g, b.g, r.h);
  r.falls = r.rises = (a.falls + a.rises) + (b.falls + b.rises);
  r.doubt = (a.doubt + b.doubt) + ((at_a - at_a) + (at_b - at_b));
  return r;
}
template <class D>
OKTETT_INLINE Variation<D> plus(const Variation<D>& a, double c) {
  Variation<D> r = a;
  r.v = plus(a.v, c), r.error = a.error + D(variation::kUnit) * variation::magnitude(r.v);
  return r;
}
template <class D>
OKTETT_INLINE Variation<D> times(const Variation<D>& a, double c) {
  const Interval<D> v = times(a.v, c);
  return variation::chain_monotone(a, v, D(std::abs(c)), D(0.0),
                                   D(variation::kUnit) * variation::magnitude(v), c > 0);
}
template <class D>
OKTETT_NOINLINE Variation<D> sqr(const Variation<D>& a) {
  const Interval<D> v = sqr(a.v), w = variation::wide(a);
  return variation::chain(a, v, D(2.0) * variation::magnitude(w), D(2.0),
                          D(variation::kUnit) * variation::magnitude(v), D(0.0) <= w.lo, w.hi <= D(0.0));
}
/// 1 / a.
template <class D>
OKTETT_NOINLINE Variation<D> inverse(const Variation<D>& a) {
  const Interval<D> w = variation::wide(a);
  const auto defined = (D(0.0) < w.lo) | (w.hi < D(0.0));
  const D least = variation::or_nan(defined, min(abs(w.lo), abs(w.hi))), s = D(1.0) / least;
  return variation::chain_monotone(a, inverse(a.v), s * s, D(2.0) * s * (s * s), D(variation::kUnit) * s,
                                   false);
}
template <class D>
OKTETT_INLINE Variation<D> operator/(const Variation<D>& a, const Variation<D>& b) {
  return a * inverse(b);
}
template <class D>
OKTETT_NOINLINE Variation<D> sqrt(const Variation<D>& a) {
  const Interval<D> w = variation::wide(a), v = sqrt(a.v);
  const D least = variation::or_nan(D(0.0) < w.lo, w.lo), slope = D(0.5) / sqrt(least);
  return variation::chain_monotone(a, v, slope, D(0.5) * slope / least, D(variation::kUnit) * sqrt(w.hi));
}
template <class D>
OKTETT_NOINLINE Variation<D> abs(const Variation<D>& a) {
  const Interval<D> w = variation::wide(a);
  const Variation<D> turned = -a;
  Variation<D> kinked = variation::either(a, turned);
  kinked.v = abs(a.v), kinked.rises = Interval<D>::infinity();
  return variation::select(D(0.0) <= w.lo, a, variation::select(w.hi <= D(0.0), turned, kinked));
}
template <class D>
OKTETT_NOINLINE Variation<D> min(const Variation<D>& a, const Variation<D>& b) {
  const Interval<D> u = variation::wide(a), w = variation::wide(b);
  Variation<D> kinked = variation::either(a, b);
  kinked.v = min(a.v, b.v), kinked.falls = Interval<D>::infinity();
  return variation::select(u.hi < w.lo, a, variation::select(w.hi < u.lo, b, kinked));
}
template <class D>
OKTETT_INLINE Variation<D> max(const Variation<D>& a, const Variation<D>& b) {
  return -min(-a, -b);
}
template <class D>
OKTETT_NOINLINE Variation<D> exp(const Variation<D>& a) {
  const Interval<D> w = variation::wide(a), v = exp(a.v);
  const D most = exp(Interval<D>(w.hi)).hi;
  return variation::chain_monotone(a, v, most, most,
                                   (D(1.0) + variation::magnitude(w)) * (D(variation::kUnit * 2) * most));
}
template <class D>
OKTETT_NOINLINE Variation<D> log(const Variation<D>& a) {
  const Interval<D> w = variation::wide(a), v = log(a.v);
  const D s = D(1.0) / variation::or_nan(D(0.0) < w.lo, w.lo);
  return variation::chain_monotone(a, v, s, s * s,
                                   D(variation::kUnit * 4) * (D(1.0) + variation::magnitude(v)));
}
/// For whole n.
template <class D>
OKTETT_NOINLINE Variation<D> pow(const Variation<D>& a, int n) {
  const Interval<D> w = variation::wide(a);
  if (n == 0) {
    Variation<D> one = variation::constant(D(1.0));
    one.v = pow(a.v, 0), one.doubt = a.doubt;
    return one;
  }
  if (n < 0) return inverse(pow(a, -n));
  if (n == 1) return a;
  if (n == 2) return sqr(a);
  const D most = variation::magnitude(w), bend = D(n) * D(n - 1) * lane::pow_whole(most, n - 2);
  const D slope = D(n) * lane::pow_whole(most, n - 1);
  const auto positive = D(0.0) <= w.lo, odd = n % 2 == 1 ? D::M::all_true() : positive;
  return variation::chain(a, pow(a.v, n), slope, bend, D(variation::kUnit * 2) * slope * most, positive | odd,
                          (w.hi <= D(0.0)) & ~odd);
}
template <class D>
OKTETT_NOINLINE Variation<D> pow(const Variation<D>& a, double y) {
  const Interval<D> w = variation::wide(a), v = pow(a.v, y);
  const auto positive = D(0.0) < w.lo;
  const Interval<D> base{variation::or_nan(positive, w.lo), variation::or_nan(positive, w.hi)};
  const D slope = variation::magnitude(pow(base, y - 1) * D(y));
  const D bend = variation::magnitude(pow(base, y - 2) * D(y * (y - 1)));
  // The exponent of 2 is at most 1100 in size where the power is a number.
  const D own = D(0x1p-36) * variation::magnitude(pow(base, y));
  return variation::chain_monotone(a, v, slope, bend, own, y > 0);
}
template <class D>
OKTETT_NOINLINE void sin_cos(const Variation<D>& a, Variation<D>& sin, Variation<D>& cos) {
  const Interval<D> w = variation::wide(a);
  Interval<D> s, c, ws, wc;
  sin_cos(a.v, s, c);
  sin_cos(w, ws, wc);
  const D far = variation::or_nan(variation::magnitude(w) < D(lane::kMaxAngle), D(0.0));
  const D own = D(variation::kSine) + far;
  const D up = variation::magnitude(ws), down = variation::magnitude(wc), zero(0.0);
  sin = variation::chain(a, s, down, up, own, zero <= wc.lo, wc.hi <= zero);
  cos = variation::chain(a, c, up, down, own, ws.hi <= zero, zero <= ws.lo);
}
template <class D>
OKTETT_NOINLINE Variation<D> tan(const Variation<D>& a) {
  Variation<D> s, c;
  sin_cos(a, s, c);
  Variation<D> r = s / c;
  r.v = tan(a.v);
  return r;
}
template <class D>
OKTETT_NOINLINE Variation<D> atan(const Variation<D>& a) {
  const Interval<D> w = variation::wide(a), size = abs(w);
  // 2 x / (1 + x^2)^2 is below 0.65 everywhere.
  const D s = D(1.0) / (D(1.0) + size.lo * size.lo);
  return variation::chain_monotone(a, atan(a.v), s, min(D(0.65), D(2.0) * size.hi * (s * s)),
                                   D(variation::kArc));
}

namespace variation {

/// asin if `rising`, else acos, which is pi/2 - asin.
template <class D>
OKTETT_INLINE Variation<D> arc(const Variation<D>& a, const Interval<D>& v, bool rising) {
  const D most = magnitude(wide(a)), rest = (D(1.0) - most) * (D(1.0) + most);
  const D s = D(1.0) / oktett::sqrt(or_nan(D(0.0) < rest, rest));
  return chain_monotone(a, v, s, most * s * (s * s), D(kArc) * s, rising);
}

}  // namespace variation

template <class D>
OKTETT_NOINLINE Variation<D> asin(const Variation<D>& a) {
  return variation::arc(a, asin(a.v), true);
}
template <class D>
OKTETT_NOINLINE Variation<D> acos(const Variation<D>& a) {
  return variation::arc(a, acos(a.v), false);
}
template <class D>
OKTETT_NOINLINE Variation<D> atan2(const Variation<D>& y, const Variation<D>& x) {
  const D zero(0.0);
  const Interval<D> wy = variation::wide(y), wx = variation::wide(x);
  const auto smooth = (zero < wx.lo) | (zero < wy.lo) | (wy.hi < zero);
  const D near_x = select(zero < wx.lo, wx.lo, select(wx.hi < zero, -wx.hi, zero));
  const D near_y = select(zero < wy.lo, wy.lo, select(wy.hi < zero, -wy.hi, zero));
  // The derivatives of the angle at a distance of r from the origin: 1/r, and 1/r^2.
  const D s = D(1.0) / variation::or_nan(smooth, sqrt(near_x * near_x + near_y * near_y));
  // They bound those of the angle by y and by x alike, so the chain rule for the sum bounds the angle.
  const auto neither = ~D::M::all_true();
  return variation::chain(y + x, atan2(y.v, x.v), s, s * s, D(variation::kArc), neither, neither);
}
template <class D>
OKTETT_NOINLINE Variation<D> floor(const Variation<D>& a) {
  const Interval<D> w = floor(variation::wide(a));
  return variation::stepped(a, w.lo, w.hi);
}
template <class D>
OKTETT_NOINLINE Variation<D> ceil(const Variation<D>& a) {
  const Interval<D> w = ceil(variation::wide(a));
  return variation::stepped(a, w.lo, w.hi);
}
template <class D>
OKTETT_NOINLINE Variation<D> round(const Variation<D>& a) {
  const Interval<D> w = round(variation::wide(a));
  return variation::stepped(a, w.lo, w.hi);
}
template <class D>
OKTETT_NOINLINE Variation<D> sign(const Variation<D>& a) {
  const Interval<D> w = sign(variation::wide(a));
  return variation::stepped(a, w.lo, w.hi);
}

template <class D>
OKTETT_NOINLINE Variation<D> noise(const Variation<D>& x, const Variation<D>& y, const Variation<D>& z,
                                   NoiseKind kind) {
  const NoiseBounds most = bounds_of(kind);
  const Variation<D>* const of[3] = {&x, &y, &z};
  Interval<D> range[3], around;
  Variation<D> r = variation::constant(D(0.0));
  noise_lanes::range(x.v, y.v, z.v, kind, r.v, range);
  noise_lanes::range(variation::wide(x), variation::wide(y), variation::wide(z), kind, around, range);
  r.error = D(kNoiseError);
  for (int k = 0; k < 3; ++k) {
    const Variation<D>& a = *of[k];
    const D slope = variation::magnitude(range[k]), sum = variation::total(a.g);
    r.error = r.error + slope * a.error;
    r.g = add_lanes(r.g, scale_lanes(a.g, slope));
    // The derivatives change with the errors of all three operands.
    D wrong(kNoiseSlopeError);
    for (int j = 0; j < 3; ++j) wrong = wrong + D(j == k ? most.bend : most.twist) * of[j]->error;
    r.slope_error = r.slope_error + slope * (a.slope_error + D(variation::kSlope) * sum) + wrong * sum;
    for (int i = 0; i < 6; ++i) r.h[i] = r.h[i] + slope * a.h[i];
    variation::add_products(D(0.5 * most.bend), a.g, a.g, r.h);
    for (int j = 0; j < k; ++j) variation::add_products(D(most.twist), a.g, of[j]->g, r.h);
    r.falls = r.falls + (a.falls + a.rises);
    r.doubt = r.doubt + a.doubt + (slope - slope);
  }
  r.rises = r.falls;
  return r;
}

}  // namespace oktett
