#pragma once
/// \file Powers of |x| as superquadrics take them, and the pseudo-powers of ratioquadrics,
/// g_p(x) = x / (p + (1 - p) x) (C. Blanc, C. Schlick: Ratioquadrics, 1996). Both rise from 0 through
/// g(1) = 1; their slopes rise if p >= 1 and fall if p <= 1. For p > 1 a pseudo-power has a pole at
/// p / (p - 1): from there on it counts as infinite.

#include "kernels/exact/convex.h"

namespace oktett {

struct SuperExponent {
  double p = 2;
  int whole = 2;  ///< p if it is a small whole number, else 0

  SuperExponent() = default;
  explicit SuperExponent(double x)
      : p(x), whole(x == static_cast<int>(x < 32 ? x : 0) ? static_cast<int>(x) : 0) {}
};

/// What rounding x does to the slope of a convex power (p >= 1) for |x| below about 1. Rounding that moves x
/// by less than `vague` of itself changes the slope by less than `bend` times as much of itself. Otherwise
/// x is so small that the slope is below `noise`, as is its error.
struct SuperRounding {
  double vague, bend, noise;
};

namespace interval {

/// |x|^p by the ends of |x|, lo <= hi, and the slope by |x|.
template <class D>
OKTETT_INLINE Dual<Interval<D>> power_between(const Interval<D>& x, const SuperExponent& e) {
  const Interval<D> v = e.whole > 0 ? pow_positive(x, e.whole) : pow_positive(x, e.p);
  if (e.p == 1) return {v, Interval<D>(D(1.0))};
  // The slope is p x^(p-1) = p v / x, of which v.lo belongs to x.lo and v.hi to x.hi.
  const D p(e.p), tiny(1e-250);
  const D at_lo = p * v.lo / x.lo, at_hi = p * v.hi / x.hi;
  if (e.p > 1) {
    const D least = select(tiny < x.lo, at_lo, D(0.0)), most = select(D(0.0) < x.hi, at_hi, D(0.0));
    return {v, outward_positive(least, most, D(0x1p-50))};
  }
  // It falls: v.lo may be too small and v.hi too large for it, by far less than 2^-30.
  const D most = select(tiny < x.lo, at_lo * D(1 + 0x1p-30), Interval<D>::infinity());
  const D least = select(tiny < x.hi, at_hi * D(1 - 0x1p-30), D(0.0));
  return {v, outward_positive(least, most, D(0x1p-50))};
}

/// g_p at the point x >= 0 and its denominator.
template <class D>
OKTETT_INLINE Interval<D> ratio_denominator(const D& x, double p) {
  const Interval<D> one(D(1.0)), exponent{D(p)};
  return exponent + (one - exponent) * Interval<D>(x);
}
template <class D>
OKTETT_INLINE Dual<Interval<D>> ratio_between(const Interval<D>& x, const SuperExponent& e) {
  const D zero(0.0), inf = Interval<D>::infinity(), greatest(kGreatest), huge(1e150), p(e.p);
  const D lo = min(huge, x.lo), hi = min(huge, x.hi);
  const Interval<D> b_lo = ratio_denominator(lo, e.p), b_hi = ratio_denominator(hi, e.p);
  const Interval<D> ends = outward_positive(lo / b_lo.hi, hi / b_hi.lo);
  Interval<D> v{select(zero < b_lo.hi, ends.lo, greatest), select(zero < b_hi.lo, ends.hi, inf)};
  if (e.p < 1) v.hi = min(v.hi, D(1 / (1 - e.p) * (1 + 0x1p-48)));
  // p / b^2 rises with x for p > 1 and falls for p < 1.
  const Interval<D>&slow = e.p >= 1 ? b_lo : b_hi, &fast = e.p >= 1 ? b_hi : b_lo;
  const Interval<D> g = outward_positive(p / (slow.hi * slow.hi), p / (fast.lo * fast.lo), D(0x1p-49));
  const D most = select((zero < fast.lo) & (x.hi < huge), g.hi, inf);
  const D least = select((zero < slow.hi) & (x.hi < huge), g.lo, zero);
  return {v, {least, most}};
}

/// The power of |x|, or the pseudo-power.
template <class D>
OKTETT_NOINLINE Dual<Interval<D>> super_power(const Dual<Interval<D>>& x, const SuperExponent& e,
                                              bool ratio) {
  const Interval<D> size = abs(x.v);
  Dual<Interval<D>> r = ratio ? ratio_between(size, e) : power_between(size, e);
  const D one(1.0), zero(0.0);
  const Interval<D> side{select(zero <= x.v.lo, one, -one), select(x.v.hi <= zero, -one, one)};
  const auto still = (x.d.lo == zero) & (x.d.hi == zero);
  r.d = select(still, Interval<D>(zero), carry(x.v, r.d * (side * x.d)));
  r.v = carry(x.v, r.v);
  return r;
}

}  // namespace interval

/// Value, slope, and the value's relative error, of the power of x >= 0, by plain arithmetic.
template <bool kRatio, class D>
OKTETT_INLINE void sample_power(const D& x, const SuperExponent& e, D& value, D& slope, D& relative) {
  const D p(e.p), inf(std::numeric_limits<double>::infinity());
  if constexpr (kRatio) {
    const D below = p + D(1 - e.p) * x, inverse = D(1.0) / below;
    const auto defined = below > D(0.0);
    value = select(defined, x * inverse, inf), slope = select(defined, p * inverse * inverse, inf);
    // The sum cancels near the pole.
    relative = D(0x1p-50) * (p + abs(D(1 - e.p)) * x) * inverse + D(0x1p-50);
  } else if (e.whole > 0) {
    const D below = e.whole > 1 ? lane::pow_whole(x, e.whole - 1) : D(1.0);
    value = below * x, slope = p * below, relative = D(e.p * 0x1p-52);
  } else {
    D exponent;
    value = lane::pow(x, p, exponent);
    slope = select(x > D(0.0), p * value / x, D(0.0));
    relative = lane::pow_error(exponent) + D(0x1p-50);
  }
}

}  // namespace oktett
