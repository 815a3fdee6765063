#pragma once
/// \file Intervals with their derivatives by one variable. Where a function has a kink its derivative is the
/// hull of those on both sides; where it has a step it is entire.
/// With that a bounded derivative over an interval X proves the mean value theorem on X:
/// f(X) is within f(m) + f'(X) (X - m).

#include "kernels/interval/trigonometry.h"

namespace oktett {

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
