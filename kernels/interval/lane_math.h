#pragma once
/// \file Elementary functions of doubles in lanes whose errors are bounded: they are proven in
/// docs/interval.md.

#include <numbers>

#include "core/elementary.h"

namespace oktett::lane {

/// Bounds on the relative errors of log, log2, atan, asin and acos, and of exp2 for exact arguments.
inline constexpr double kLogError = 0x1p-49, kExp2Error = 0x1p-50, kAtanError = 0x1p-48;
/// Bound on the absolute error of sin and cos for |x| <= kMaxAngle, and the greatest |x| they are meant for.
inline constexpr double kSinError = 0x1p-50, kMaxAngle = 1.6e6;

using oktett::pow_whole;
using oktett::round_even;

/// 2^x; overflows to infinity, underflows gradually. NaN gives NaN.
template <class D>
OKTETT_INLINE D exp2(const D& x) {
  const D clamped = min(D(1100.0), max(D(-1100.0), x));
  return exp2_near<Estrin>(clamped, round_even(clamped));
}

/// Logarithms: -infinity at 0, infinity at infinity, NaN below 0 and at NaN.
template <class D>
OKTETT_INLINE D log2(const D& x) {
  return log2_by<Estrin, false>(x);
}
template <class D>
OKTETT_INLINE D log(const D& x) {
  return log_by<Estrin, false>(x);
}

/// x^y for x >= 0 and finite y > 0; `exponent` = y log2 x tells the relative error, see pow_error.
template <class D>
OKTETT_INLINE D pow(const D& x, const D& y, D& exponent) {
  exponent = y * log2(x);
  return exp2(exponent);
}
/// Bound on the relative error of what pow returned; where it neither overflows nor underflows.
template <class D>
OKTETT_INLINE D pow_error(const D& exponent) {
  return min(abs(exponent), D(1100.0)) * D(0x1p-49) + D(kExp2Error);
}

/// Sine and cosine of x radians, |x| <= kMaxAngle.
template <class D>
OKTETT_INLINE void sin_cos(const D& x, D& sin, D& cos) {
  const D k = round_even(x * D(2 / std::numbers::pi)), r = without_quarters(x, k);
  const D s = sin_of_eighth(r), c = cos_of_eighth(r);
  // The quadrant, k mod 4 as -2, -1, 0, 1 or 2.
  const D quadrant = k - D(4.0) * round_even(k * D(0.25));
  const auto odd = abs(quadrant) == D(1.0), opposite = abs(quadrant) == D(2.0);
  const D a = select(odd, c, s), b = select(odd, s, c);
  sin = select(opposite | (quadrant == D(-1.0)), -a, a);
  cos = select(opposite | (quadrant == D(1.0)), -b, b);
}

/// Angle of the point (x, y) for x >= 0, y >= 0, not both 0 or infinite.
template <class D>
OKTETT_INLINE D atan2_quadrant(const D& y, const D& x) {
  const auto flat = y <= x;
  const D a = atan_unit(select(flat, y, x) / select(flat, x, y));
  return select(flat, a, D(std::numbers::pi / 2) - a);
}
template <class D>
OKTETT_INLINE D atan(const D& x) {
  const D a = atan2_quadrant(abs(x), D(1.0));
  return select(x < D(0.0), -a, a);
}
/// For |x| <= 1.
template <class D>
OKTETT_INLINE D asin(const D& x) {
  const D a = atan2_quadrant(abs(x), sqrt((D(1.0) - x) * (D(1.0) + x)));
  return select(x < D(0.0), -a, a);
}
template <class D>
OKTETT_INLINE D acos(const D& x) {
  return D(2.0) * atan2_quadrant(sqrt(D(1.0) - x), sqrt(D(1.0) + x));
}

}  // namespace oktett::lane
