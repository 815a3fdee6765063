#pragma once
/// \file Intervals in lanes, rounded outwards without changing the rounding mode.
///
/// An interval holds every value that a function takes for arguments in the given intervals, where it is
/// defined. Where it may be undefined for some of them the result is *entire*, [-infinity, infinity], and
/// remains so in every further operation, even sqr or sin. Where it is undefined for all of them the result
/// is *void*, both ends NaN, and also remains so. Hence, if a result is neither, the function is defined for
/// all arguments.
///
/// A rounded result x is off by at most 2^-53 |x|, or by 2^-1075 where it underflows: moved by
/// 2^-52 |x| + 2^-1000 it lies beyond the true one (docs/interval.md).

#include "kernels/interval/lane_math.h"

namespace oktett {

template <class D>
struct Interval {
  D lo, hi;

  Interval() = default;
  OKTETT_INLINE explicit Interval(const D& x) : lo(x), hi(x) {}
  OKTETT_INLINE Interval(const D& l, const D& h) : lo(l), hi(h) {}

  static OKTETT_INLINE D infinity() { return D(std::numeric_limits<double>::infinity()); }
  static OKTETT_INLINE Interval entire() { return {-infinity(), infinity()}; }
  static OKTETT_INLINE Interval nothing() {
    const D nan(std::numeric_limits<double>::quiet_NaN());
    return {nan, nan};
  }
  OKTETT_INLINE typename D::M is_entire() const { return (lo == -infinity()) & (hi == infinity()); }
  OKTETT_INLINE typename D::M is_void() const { return ~(lo == lo); }
  /// Both ends are numbers: the function is defined and bounded.
  OKTETT_INLINE typename D::M is_bounded() const { return (-infinity() < lo) & (hi < infinity()); }
  OKTETT_INLINE typename D::M has_zero() const { return (lo <= D(0.0)) & (D(0.0) <= hi); }
};

template <class D>
OKTETT_INLINE Interval<D> select(const typename D::M& m, const Interval<D>& a, const Interval<D>& b) {
  return {select(m, a.lo, b.lo), select(m, a.hi, b.hi)};
}

namespace interval {

inline constexpr double kRound = 0x1p-52, kTiny = 0x1p-1000;
inline constexpr double kGreatest = std::numeric_limits<double>::max();

/// [lo, hi] with both ends moved outwards by `relative` times their size plus 2^-1000. A lower end of
/// +infinity becomes the greatest number, an upper end of -infinity the least.
template <class D>
OKTETT_INLINE Interval<D> outward(D lo, D hi, const D& relative = D(kRound)) {
  lo = min(D(kGreatest), lo), hi = max(D(-kGreatest), hi);
  return {lo - (abs(lo) * relative + D(kTiny)), hi + (abs(hi) * relative + D(kTiny))};
}
/// The same for sums. They never underflow, so each end has the sign of the true one.
template <class D>
OKTETT_INLINE Interval<D> outward_sum(D lo, D hi) {
  lo = min(D(kGreatest), lo), hi = max(D(-kGreatest), hi);
  return {lo - abs(lo) * D(kRound), hi + abs(hi) * D(kRound)};
}
/// As `outward`, for results that cannot be negative.
template <class D>
OKTETT_INLINE Interval<D> outward_positive(const D& lo, const D& hi, const D& relative = D(kRound)) {
  const Interval<D> r = outward(lo, hi, relative);
  return {max(r.lo, D(0.0)), r.hi};
}

/// `r`, made entire or void where the argument `a` is.
template <class D>
OKTETT_INLINE Interval<D> carry(const Interval<D>& a, const Interval<D>& r) {
  const auto entire = a.is_entire(), defined = a.lo == a.lo;
  const D inf = Interval<D>::infinity();
  return {select(defined, select(entire, -inf, r.lo), a.lo),
          select(defined, select(entire, inf, r.hi), a.lo)};
}
template <class D>
OKTETT_INLINE Interval<D> carry(const Interval<D>& a, const Interval<D>& b, const Interval<D>& r) {
  const auto entire = a.is_entire() | b.is_entire(), defined = (a.lo == a.lo) & (b.lo == b.lo);
  const Interval<D> x = select(entire, Interval<D>::entire(), r);
  return select(defined, x, Interval<D>::nothing());
}
/// `r` where all of `a` is in [least, greatest], entire where some may be, void where nothing is.
template <class D>
OKTETT_INLINE Interval<D> inside_domain(const Interval<D>& a, const D& least, const D& greatest,
                                        const Interval<D>& r) {
  const auto all = (least <= a.lo) & (a.hi <= greatest), some = (least <= a.hi) & (a.lo <= greatest);
  return carry(a, select(all, r, select(some, Interval<D>::entire(), Interval<D>::nothing())));
}

}  // namespace interval

template <class D>
OKTETT_INLINE Interval<D> operator-(const Interval<D>& a) {
  return {-a.hi, -a.lo};
}
template <class D>
OKTETT_INLINE Interval<D> operator+(const Interval<D>& a, const Interval<D>& b) {
  return interval::outward_sum(a.lo + b.lo, a.hi + b.hi);
}
template <class D>
OKTETT_INLINE Interval<D> operator-(const Interval<D>& a, const Interval<D>& b) {
  return interval::outward_sum(a.lo - b.hi, a.hi - b.lo);
}
template <class D>
OKTETT_INLINE Interval<D> operator*(const Interval<D>& a, const Interval<D>& b) {
  const D p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  Interval<D> x = interval::outward(min(min(p, q), min(r, s)), max(max(p, q), max(r, s)));
  // A product of non-negative numbers is not negative, even if it underflows.
  const auto positive = (D(0.0) <= a.lo) & (D(0.0) <= b.lo);
  x.lo = select(positive & (x.lo < D(0.0)), D(0.0), x.lo);
  const auto sound = (p == p) & (q == q) & (r == r) & (s == s);
  if (OKTETT_UNLIKELY(any(~sound))) {
    // Zero times infinity, or an undefined factor.
    const auto defined = (a.lo == a.lo) & (b.lo == b.lo);
    x = select(sound, x, select(defined, Interval<D>::entire(), Interval<D>::nothing()));
  }
  return x;
}
/// By a number.
template <class D>
OKTETT_INLINE Interval<D> operator*(const Interval<D>& a, const D& b) {
  const D p = a.lo * b, q = a.hi * b;
  const Interval<D> x = interval::outward(min(p, q), max(p, q));
  const Interval<D> unsound = select(a.is_void(), a, Interval<D>::entire());
  return select(~a.is_bounded() & (a.is_void() | (b == D(0.0))), unsound, x);
}
/// 1 / a, void for zero itself.
template <class D>
OKTETT_NOINLINE Interval<D> inverse(const Interval<D>& a) {
  const D zero(0.0), inf = Interval<D>::infinity();
  Interval<D> r = interval::outward(D(1.0) / a.hi, D(1.0) / a.lo);
  r.lo = select(a.hi == zero, -inf, r.lo), r.hi = select(a.lo == zero, inf, r.hi);
  r.lo = select((zero <= a.lo) & (r.lo < zero), zero, r.lo);
  r.hi = select((a.hi <= zero) & (zero < r.hi), zero, r.hi);
  const auto pole = (a.lo < zero) & (zero < a.hi), nowhere = (a.lo == zero) & (a.hi == zero);
  const Interval<D> x = interval::carry(a, select(pole, Interval<D>::entire(), r));
  return select(nowhere, Interval<D>::nothing(), x);
}
/// Entire where the divisor contains zero in its interior, or zero that the dividend contains too; void where
/// the divisor is zero throughout.
template <class D>
OKTETT_INLINE Interval<D> operator/(const Interval<D>& a, const Interval<D>& b) {
  return a * inverse(b);
}

/// The least interval that contains both; void if one of them is.
template <class D>
OKTETT_INLINE Interval<D> hull(const Interval<D>& a, const Interval<D>& b) {
  return interval::carry(a, b, {min(a.lo, b.lo), max(a.hi, b.hi)});
}
/// The intersection of two enclosures of the same values.
template <class D>
OKTETT_INLINE Interval<D> intersect(const Interval<D>& a, const Interval<D>& b) {
  return {max(a.lo, b.lo), min(a.hi, b.hi)};
}
template <class D>
OKTETT_INLINE Interval<D> min(const Interval<D>& a, const Interval<D>& b) {
  return interval::carry(a, b, {min(a.lo, b.lo), min(a.hi, b.hi)});
}
template <class D>
OKTETT_INLINE Interval<D> max(const Interval<D>& a, const Interval<D>& b) {
  return interval::carry(a, b, {max(a.lo, b.lo), max(a.hi, b.hi)});
}
template <class D>
OKTETT_INLINE Interval<D> abs(const Interval<D>& a) {
  const D p = abs(a.lo), q = abs(a.hi);
  return interval::carry(a, {select(a.has_zero(), D(0.0), min(p, q)), max(p, q)});
}
template <class D>
OKTETT_INLINE Interval<D> sqr(const Interval<D>& a) {
  const Interval<D> m = abs(a);
  return interval::carry(a, interval::outward_positive(m.lo * m.lo, m.hi * m.hi));
}
/// Void below 0, entire where the argument reaches below 0.
template <class D>
OKTETT_INLINE Interval<D> sqrt(const Interval<D>& a) {
  const D l = max(a.lo, D(0.0)), h = max(a.hi, D(0.0));
  const Interval<D> r = interval::outward_positive(sqrt(l), sqrt(h));
  return interval::inside_domain(a, D(0.0), Interval<D>::infinity(), r);
}

template <class D>
OKTETT_NOINLINE Interval<D> exp2(const Interval<D>& a) {
  // The argument is exact; the series has its error.
  return interval::carry(
      a, interval::outward_positive(lane::exp2(a.lo), lane::exp2(a.hi), D(lane::kExp2Error * 2)));
}
template <class D>
OKTETT_NOINLINE Interval<D> exp(const Interval<D>& a) {
  // log2(e) as a double is low by less than 2^-54 of itself.
  const D log2e(std::numbers::log2e);
  const Interval<D> x = interval::outward(a.lo * log2e, a.hi * log2e, D(0x1p-51));
  return exp2(interval::carry(a, x));
}
/// Void where the argument is at most 0, entire where part of it is.
template <class D>
OKTETT_NOINLINE Interval<D> log(const Interval<D>& a) {
  const D zero(0.0), l = lane::log(max(a.lo, zero)), h = lane::log(max(a.hi, zero));
  const Interval<D> r = interval::outward(l, h, D(lane::kLogError * 2));
  const Interval<D> x = interval::inside_domain(a, zero, Interval<D>::infinity(), r);
  // At 0 the logarithm is -infinity, whatever the rounding; only [0, 0] holds nothing else.
  return select((a.lo == zero) & (a.hi == zero), Interval<D>::nothing(), x);
}

/// x^y for a number y > 0 and x >= 0; elsewhere as sqrt.
template <class D>
OKTETT_NOINLINE Interval<D> pow_positive(const Interval<D>& a, double exponent) {
  const D y(exponent);
  D e_lo, e_hi;
  const D l = lane::pow(max(a.lo, D(0.0)), y, e_lo), h = lane::pow(max(a.hi, D(0.0)), y, e_hi);
  const D error = max(lane::pow_error(e_lo), lane::pow_error(e_hi));
  const Interval<D> r = interval::outward_positive(l, h, error * D(2.0));
  return interval::inside_domain(a, D(0.0), Interval<D>::infinity(), r);
}
/// x^y for any number y and x >= 0; elsewhere as sqrt. 0^y = 0 for y > 0, and a pole for y < 0.
template <class D>
OKTETT_NOINLINE Interval<D> pow(const Interval<D>& a, double exponent) {
  if (exponent == 0) return interval::inside_domain(a, D(0.0), Interval<D>::infinity(), Interval<D>(D(1.0)));
  const Interval<D> r = pow_positive(a, exponent < 0 ? -exponent : exponent);
  return exponent < 0 ? inverse(r) : r;
}
/// x^n for whole n > 0.
template <class D>
OKTETT_NOINLINE Interval<D> pow_positive(const Interval<D>& a, int n) {
  if (n == 1) return a;
  if (n == 2) return sqr(a);
  const D error(n * interval::kRound);
  if (n % 2 == 0) {
    const Interval<D> m = abs(a);
    return interval::carry(
        a, interval::outward_positive(lane::pow_whole(m.lo, n), lane::pow_whole(m.hi, n), error));
  }
  Interval<D> r = interval::outward(lane::pow_whole(a.lo, n), lane::pow_whole(a.hi, n), error);
  r.lo = select((D(0.0) <= a.lo) & (r.lo < D(0.0)), D(0.0), r.lo);
  return interval::carry(a, r);
}
/// x^n for whole n, for n < 0 with a pole at 0.
template <class D>
OKTETT_NOINLINE Interval<D> pow(const Interval<D>& a, int n) {
  if (n == 0) return interval::carry(a, Interval<D>(D(1.0)));
  const Interval<D> r = pow_positive(a, n < 0 ? -n : n);
  return n < 0 ? inverse(r) : r;
}

}  // namespace oktett
