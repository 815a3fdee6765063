#pragma once
/// \file Interval arithmetic in lanes of double, rounded outwards without changing the processor's rounding
/// mode: each end is moved by a unit in the last place and a tiny amount (R. E. Moore: Interval Analysis, 1966).
/// Where a value is not defined, the interval is everything.

#include <limits>

#include "kernels/interval/lane_math.h"

namespace oktett {

template <class D>
struct Interval {
  D lo, hi;
};

namespace interval {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kTiny = 0x1p-1000;

/// A number at or below (above) `x` by at least its rounding error.
template <class D>
OKTETT_INLINE D down(const D& x, double relative = 0x1p-52) {
  return min(x * D(1 - relative), x * D(1 + relative)) - D(kTiny);
}
template <class D>
OKTETT_INLINE D up(const D& x, double relative = 0x1p-52) {
  return max(x * D(1 - relative), x * D(1 + relative)) + D(kTiny);
}

/// NaN at an end stands for no bound.
template <class D>
OKTETT_INLINE Interval<D> bounded(const D& lo, const D& hi) {
  return {select(lo == lo, lo, D(-kInfinity)), select(hi == hi, hi, D(kInfinity))};
}

template <class D>
OKTETT_INLINE Interval<D> point(const D& x) {
  return {x, x};
}
template <class D>
OKTETT_INLINE Interval<D> everything() {
  return {D(-kInfinity), D(kInfinity)};
}

/// 0 times infinity is 0: a factor that is 0 makes the product 0 however large the other may be.
template <class D>
OKTETT_INLINE D product(const D& a, const D& b) {
  const D p = a * b;
  return select(p == p, p, D(0.0));
}

}  // namespace interval

template <class D>
OKTETT_INLINE Interval<D> operator+(const Interval<D>& a, const Interval<D>& b) {
  return interval::bounded(interval::down(a.lo + b.lo), interval::up(a.hi + b.hi));
}
template <class D>
OKTETT_INLINE Interval<D> operator-(const Interval<D>& a, const Interval<D>& b) {
  return interval::bounded(interval::down(a.lo - b.hi), interval::up(a.hi - b.lo));
}
template <class D>
OKTETT_INLINE Interval<D> operator-(const Interval<D>& a) {
  return {-a.hi, -a.lo};
}
template <class D>
OKTETT_INLINE Interval<D> operator*(const Interval<D>& a, const Interval<D>& b) {
  using interval::product;
  const D p = product(a.lo, b.lo), q = product(a.lo, b.hi), r = product(a.hi, b.lo), s = product(a.hi, b.hi);
  return {interval::down(min(min(p, q), min(r, s))), interval::up(max(max(p, q), max(r, s)))};
}
/// By a number, which is exact.
template <class D>
OKTETT_INLINE Interval<D> scale(const Interval<D>& a, double k) {
  const D p = a.lo * D(k), q = a.hi * D(k);
  return k < 0 ? Interval<D>{interval::down(q), interval::up(p)} : Interval<D>{interval::down(p), interval::up(q)};
}
/// Everything if the divisor may be 0.
template <class D>
OKTETT_INLINE Interval<D> operator/(const Interval<D>& a, const Interval<D>& b) {
  const auto safe = (b.lo > D(0.0)) | (b.hi < D(0.0));
  const Interval<D> inverse{interval::down(D(1.0) / b.hi), interval::up(D(1.0) / b.lo)};
  const Interval<D> q = a * inverse;
  return {select(safe, q.lo, D(-interval::kInfinity)), select(safe, q.hi, D(interval::kInfinity))};
}
template <class D>
OKTETT_INLINE Interval<D> abs(const Interval<D>& a) {
  const auto holds_zero = (a.lo <= D(0.0)) & (a.hi >= D(0.0));
  const D p = abs(a.lo), q = abs(a.hi);
  return {select(holds_zero, D(0.0), min(p, q)), max(p, q)};
}
/// What both hold.
template <class D>
OKTETT_INLINE Interval<D> intersect(const Interval<D>& a, const Interval<D>& b) {
  return {max(b.lo, a.lo), min(b.hi, a.hi)};
}
template <class D>
OKTETT_INLINE Interval<D> select(const typename D::M& m, const Interval<D>& a, const Interval<D>& b) {
  return {select(m, a.lo, b.lo), select(m, a.hi, b.hi)};
}

/// A value and its derivative along the ray.
template <class D>
struct Slope {
  Interval<D> v, d;
};

template <class D>
OKTETT_INLINE Slope<D> operator+(const Slope<D>& a, const Slope<D>& b) {
  return {a.v + b.v, a.d + b.d};
}
template <class D>
OKTETT_INLINE Slope<D> operator-(const Slope<D>& a, const Slope<D>& b) {
  return {a.v - b.v, a.d - b.d};
}
template <class D>
OKTETT_INLINE Slope<D> operator*(const Slope<D>& a, const Slope<D>& b) {
  return {a.v * b.v, a.d * b.v + a.v * b.d};
}
template <class D>
OKTETT_INLINE Slope<D> operator/(const Slope<D>& a, const Slope<D>& b) {
  const Interval<D> q = a.v / b.v;
  return {q, (a.d - q * b.d) / b.v};
}
template <class D>
OKTETT_INLINE Slope<D> scale(const Slope<D>& a, double k) {
  return {scale(a.v, k), scale(a.d, k)};
}
template <class D>
OKTETT_INLINE Slope<D> shift(const Slope<D>& a, double k) {
  return {a.v + interval::point(D(k)), a.d};
}

}  // namespace oktett
