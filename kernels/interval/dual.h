#pragma once
/// \file Intervals with their derivatives by one variable. Where a function has a kink its derivative is the
/// hull of those on both sides; where it has a step it is entire.
/// With that a bounded derivative over an interval X proves the mean value theorem on X:
/// f(X) is within f(m) + f'(X) (X - m).

#include "kernels/interval/interval.h"

namespace oktett {

// ---- Trigonometric functions, and those with steps, of intervals.

namespace interval {

/// Enclosure of sin (shift 0.25) or cos (shift 0) on `a`, given the function at its ends: it is 1
/// where x / (2 pi) - shift is whole, and -1 half way between.
template <class D>
OKTETT_INLINE Interval<D> wave(const Interval<D>& a, const D& at_lo, const D& at_hi, double shift) {
  const D turn(0.5 / std::numbers::pi), error(lane::kSinError), slack(0x1p-20 * 0x1p-10);
  const D l = a.lo * turn - D(shift), h = a.hi * turn - D(shift);
  // Beyond an extreme by less than the slack, the function is as good as the extreme: 1 - cos(2^-27) < 2^-54.
  const auto reaches = [&](const D& from, const D& to) {
    const D whole = lane::round_even(from);
    const D next = select(whole < from - slack, whole + D(1.0), whole);
    return next <= to + slack;
  };
  const D high = select(reaches(l, h), D(1.0), min(D(1.0), max(at_lo, at_hi) + error));
  const D low = select(reaches(l - D(0.5), h - D(0.5)), D(-1.0), max(D(-1.0), min(at_lo, at_hi) - error));
  const auto far = ~((D(-lane::kMaxAngle) <= a.lo) & (a.hi <= D(lane::kMaxAngle)));
  return carry(a, {select(far, D(-1.0), low), select(far, D(1.0), high)});
}

template <class D>
OKTETT_INLINE D clamp_angle(const D& x) {
  return min(max(x, D(-lane::kMaxAngle)), D(lane::kMaxAngle));
}

}  // namespace interval

template <class D>
OKTETT_NOINLINE void sin_cos(const Interval<D>& a, Interval<D>& sin, Interval<D>& cos) {
  D sl, cl, sh, ch;
  lane::sin_cos(interval::clamp_angle(a.lo), sl, cl);
  lane::sin_cos(interval::clamp_angle(a.hi), sh, ch);
  sin = interval::wave(a, sl, sh, 0.25);
  cos = interval::wave(a, cl, ch, 0.0);
}
/// Sine and cosine of what has a `sin_cos`: intervals, those with derivatives, and numbers with gradients.
template <class T>
concept HasSinCos = requires(const T& a, T& out) {
  sin_cos(a, out, out);
};
template <HasSinCos T>
OKTETT_INLINE T sin(const T& a) {
  T s, c;
  sin_cos(a, s, c);
  return s;
}
template <HasSinCos T>
OKTETT_INLINE T cos(const T& a) {
  T s, c;
  sin_cos(a, s, c);
  return c;
}
/// Entire where a pole may be in the argument.
template <class D>
OKTETT_NOINLINE Interval<D> tan(const Interval<D>& a) {
  D sl, cl, sh, ch;
  lane::sin_cos(interval::clamp_angle(a.lo), sl, cl);
  lane::sin_cos(interval::clamp_angle(a.hi), sh, ch);
  const D error(lane::kSinError), limit(lane::kMaxAngle);
  const auto around = [&](const D& x) { return Interval<D>(x - error, x + error); };
  const Interval<D> l = around(sl) / around(cl), h = around(sh) / around(ch);
  // Shorter than a period and with one sign of the cosine at both ends, certainly: no pole between them.
  const auto same = ((error < cl) & (error < ch)) | ((cl < -error) & (ch < -error));
  const auto short_enough = (a.hi - a.lo < D(3.0)) & (-limit <= a.lo) & (a.hi <= limit);
  return interval::carry(a, select(same & short_enough, Interval<D>(l.lo, h.hi), Interval<D>::entire()));
}

template <class D>
OKTETT_NOINLINE Interval<D> atan(const Interval<D>& a) {
  return interval::carry(a, interval::outward(lane::atan(a.lo), lane::atan(a.hi), D(lane::kAtanError)));
}
/// Void outside [-1, 1], entire where the argument reaches out of it.
template <class D>
OKTETT_NOINLINE Interval<D> asin(const Interval<D>& a) {
  const D one(1.0);
  const D l = lane::asin(max(min(a.lo, one), -one)), h = lane::asin(max(min(a.hi, one), -one));
  return interval::inside_domain(a, -one, one, interval::outward(l, h, D(lane::kAtanError)));
}
template <class D>
OKTETT_NOINLINE Interval<D> acos(const Interval<D>& a) {
  const D one(1.0);
  const D l = lane::acos(max(min(a.hi, one), -one)), h = lane::acos(max(min(a.lo, one), -one));
  return interval::inside_domain(a, -one, one, interval::outward_positive(l, h, D(lane::kAtanError)));
}
/// Angle of the points (x, y); all of [-pi, pi] where the origin or the cut along the negative x axis is
/// among them.
template <class D>
OKTETT_NOINLINE Interval<D> atan2(const Interval<D>& y, const Interval<D>& x) {
  const D zero(0.0);
  const auto right = zero < x.lo, above = zero < y.lo, below = y.hi < zero;
  const Interval<D> half_pi(D(std::numbers::pi / 2), D(std::numbers::pi / 2 * (1 + 0x1p-52)));
  const Interval<D> a = atan(select(right, y, x) / select(right, x, y));
  const Interval<D> around(D(-std::numbers::pi * (1 + 0x1p-52)), D(std::numbers::pi * (1 + 0x1p-52)));
  const Interval<D> r = select(right, a, select(above, half_pi - a, select(below, -half_pi - a, around)));
  return interval::carry(y, x, r);
}

// Functions with steps. `step` maps an interval by a function that never falls.

namespace interval {

/// The greatest whole number that is at most x.
template <class D>
OKTETT_INLINE D floor_lanes(const D& x) {
  const auto large = D(0x1p51) <= abs(x);
  const D whole = lane::round_even(x), below = select(x < whole, whole - D(1.0), whole);
  // Halves are exact up to 2^52.
  const D half = lane::round_even(x * D(0.5)) * D(2.0);
  const D rest = x - half;
  const D coarse = half + select(rest < D(0.0), D(-1.0), select(rest < D(1.0), D(0.0), D(1.0)));
  return select(D(0x1p52) <= abs(x), x, select(large, coarse, below));
}
template <class D>
OKTETT_INLINE D round_lanes(const D& x) {
  // Halves away from zero; x + 1/2 may round up to the next number, which the second look mends.
  const D m = abs(x), low = floor_lanes(m);
  const D r = select(D(0.5) <= m - low, low + D(1.0), low);
  return select(x < D(0.0), -r, r);
}
template <class D>
OKTETT_INLINE D sign_lanes(const D& x) {
  return select(D(0.0) < x, D(1.0), select(x < D(0.0), D(-1.0), D(0.0)));
}

}  // namespace interval

template <class D>
OKTETT_NOINLINE Interval<D> floor(const Interval<D>& a) {
  return interval::carry(a, {interval::floor_lanes(a.lo), interval::floor_lanes(a.hi)});
}
template <class D>
OKTETT_NOINLINE Interval<D> ceil(const Interval<D>& a) {
  return interval::carry(a, {-interval::floor_lanes(-a.lo), -interval::floor_lanes(-a.hi)});
}
template <class D>
OKTETT_NOINLINE Interval<D> round(const Interval<D>& a) {
  return interval::carry(a, {interval::round_lanes(a.lo), interval::round_lanes(a.hi)});
}
template <class D>
OKTETT_NOINLINE Interval<D> sign(const Interval<D>& a) {
  return interval::carry(a, {interval::sign_lanes(a.lo), interval::sign_lanes(a.hi)});
}

// ---- Intervals with their derivatives by one variable.

template <class T>
struct Dual {
  T v, d;
};

template <class T>
OKTETT_INLINE Dual<T> operator-(const Dual<T>& a) {
  return {-a.v, -a.d};
}
template <class T>
OKTETT_INLINE Dual<T> operator+(const Dual<T>& a, const Dual<T>& b) {
  return {a.v + b.v, a.d + b.d};
}
template <class T>
OKTETT_INLINE Dual<T> operator-(const Dual<T>& a, const Dual<T>& b) {
  return {a.v - b.v, a.d - b.d};
}
template <class T>
OKTETT_INLINE Dual<T> operator*(const Dual<T>& a, const Dual<T>& b) {
  return {a.v * b.v, a.d * b.v + a.v * b.d};
}
template <class T>
OKTETT_NOINLINE Dual<T> operator/(const Dual<T>& a, const Dual<T>& b) {
  const T q = a.v / b.v;
  return {q, (a.d - q * b.d) / b.v};
}

// With a number.

template <class D>
OKTETT_INLINE Interval<D> times(const Interval<D>& a, double b) {
  return a * D(b);
}
template <class D>
OKTETT_INLINE Interval<D> plus(const Interval<D>& a, double c) {
  return interval::outward_sum(a.lo + D(c), a.hi + D(c));
}
template <class D>
OKTETT_INLINE Dual<Interval<D>> plus(const Dual<Interval<D>>& a, double c) {
  return {plus(a.v, c), a.d};
}
template <class D>
OKTETT_INLINE Dual<Interval<D>> times(const Dual<Interval<D>>& a, double c) {
  return {times(a.v, c), times(a.d, c)};
}
template <class D>
OKTETT_INLINE void set(Interval<D>& r, double c) {
  r = Interval<D>(D(c));
}
template <class D>
OKTETT_INLINE void set(Dual<Interval<D>>& r, double c) {
  r = {Interval<D>(D(c)), Interval<D>(D(0.0))};
}

template <class T>
OKTETT_INLINE Dual<T> sqr(const Dual<T>& a) {
  return {sqr(a.v), times(a.v * a.d, 2)};
}
template <class T>
OKTETT_NOINLINE Dual<T> sqrt(const Dual<T>& a) {
  const T r = sqrt(a.v);
  return {r, times(a.d / r, 0.5)};
}

template <class D>
OKTETT_NOINLINE Dual<Interval<D>> abs(const Dual<Interval<D>>& a) {
  const Interval<D> turned = -a.d;
  const Interval<D> d = select(D(0.0) <= a.v.lo, a.d, select(a.v.hi <= D(0.0), turned, hull(a.d, turned)));
  return {abs(a.v), interval::carry(a.v, d)};
}
template <class D>
OKTETT_NOINLINE Dual<Interval<D>> min(const Dual<Interval<D>>& a, const Dual<Interval<D>>& b) {
  const Interval<D> d = select(a.v.hi < b.v.lo, a.d, select(b.v.hi < a.v.lo, b.d, hull(a.d, b.d)));
  return {min(a.v, b.v), interval::carry(a.v, b.v, d)};
}
template <class D>
OKTETT_INLINE Dual<Interval<D>> max(const Dual<Interval<D>>& a, const Dual<Interval<D>>& b) {
  return -min(-a, -b);
}
template <class D>
OKTETT_NOINLINE Dual<Interval<D>> exp(const Dual<Interval<D>>& a) {
  const Interval<D> e = exp(a.v);
  return {e, e * a.d};
}
template <class D>
OKTETT_NOINLINE Dual<Interval<D>> log(const Dual<Interval<D>>& a) {
  return {log(a.v), a.d / a.v};
}
template <class D>
OKTETT_NOINLINE Dual<Interval<D>> pow(const Dual<Interval<D>>& a, int n) {
  if (n == 0) return {pow(a.v, 0), interval::carry(a.v, Interval<D>(D(0.0)))};
  return {pow(a.v, n), times(pow(a.v, n - 1) * a.d, n)};
}
template <class D>
OKTETT_NOINLINE Dual<Interval<D>> pow(const Dual<Interval<D>>& a, double y) {
  return {pow(a.v, y), pow(a.v, y - 1) * Interval<D>(D(y)) * a.d};
}
template <class D>
OKTETT_INLINE void sin_cos(const Dual<Interval<D>>& a, Dual<Interval<D>>& sin, Dual<Interval<D>>& cos) {
  Interval<D> s, c;
  sin_cos(a.v, s, c);
  sin = {s, c * a.d}, cos = {c, -s * a.d};
}
template <class D>
OKTETT_NOINLINE Dual<Interval<D>> tan(const Dual<Interval<D>>& a) {
  const Interval<D> t = tan(a.v);
  return {t, (Interval<D>(D(1.0)) + sqr(t)) * a.d};
}
template <class D>
OKTETT_NOINLINE Dual<Interval<D>> atan(const Dual<Interval<D>>& a) {
  return {atan(a.v), a.d / (Interval<D>(D(1.0)) + sqr(a.v))};
}
template <class D>
OKTETT_NOINLINE Dual<Interval<D>> asin(const Dual<Interval<D>>& a) {
  return {asin(a.v), a.d / sqrt(Interval<D>(D(1.0)) - sqr(a.v))};
}
template <class D>
OKTETT_NOINLINE Dual<Interval<D>> acos(const Dual<Interval<D>>& a) {
  return {acos(a.v), -(a.d / sqrt(Interval<D>(D(1.0)) - sqr(a.v)))};
}
template <class D>
OKTETT_NOINLINE Dual<Interval<D>> atan2(const Dual<Interval<D>>& y, const Dual<Interval<D>>& x) {
  const D zero(0.0);
  const auto smooth = (zero < x.v.lo) | (zero < y.v.lo) | (y.v.hi < zero);
  const Interval<D> d = (y.d * x.v - x.d * y.v) / (sqr(x.v) + sqr(y.v));
  return {atan2(y.v, x.v), select(smooth, d, Interval<D>::entire())};
}
/// What a function with steps makes of `a`, whose value is `v`.
template <class D>
OKTETT_INLINE Dual<Interval<D>> stepped(const Interval<D>& v) {
  return {v, select(v.lo == v.hi, Interval<D>(D(0.0)), Interval<D>::entire())};
}
template <class D>
OKTETT_INLINE Dual<Interval<D>> floor(const Dual<Interval<D>>& a) {
  return stepped(floor(a.v));
}
template <class D>
OKTETT_INLINE Dual<Interval<D>> ceil(const Dual<Interval<D>>& a) {
  return stepped(ceil(a.v));
}
template <class D>
OKTETT_INLINE Dual<Interval<D>> round(const Dual<Interval<D>>& a) {
  return stepped(round(a.v));
}
template <class D>
OKTETT_INLINE Dual<Interval<D>> sign(const Dual<Interval<D>>& a) {
  return stepped(sign(a.v));
}

}  // namespace oktett
