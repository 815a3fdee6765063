#pragma once
/// \file Elementary functions of doubles in lanes, from + - * / and sqrt in a fixed order, so that every
/// width and instruction set gives the same bits. The series are those of core/math.cpp; their errors are
/// proven in docs/interval.md.

#include <cstddef>
#include <limits>
#include <numbers>

#include "core/eighth_turn.h"
#include "core/simd.h"

namespace oktett::lane {

/// Bounds on the relative errors of log, log2, atan, asin and acos, and of exp2 for exact arguments.
inline constexpr double kLogError = 0x1p-49, kExp2Error = 0x1p-50, kAtanError = 0x1p-48;
/// Bound on the absolute error of sin and cos for |x| <= kMaxAngle, and the greatest |x| they are meant for.
inline constexpr double kSinError = 0x1p-50, kMaxAngle = 1.6e6;

/// Nearest whole number for |x| < 2^51, halves to even.
template <class D>
OKTETT_INLINE D round_even(const D& x) {
  const D magic(0x1.8p52);
  return (x + magic) - magic;
}

/// Estrin's scheme for sixteen coefficients, from the lowest power up: shorter chains than Horner's.
template <class D>
OKTETT_INLINE D estrin16(const double (&c)[16], const D& x) {
  const D x2 = x * x, x4 = x2 * x2, x8 = x4 * x4;
  const auto pair = [&](int i) { return D(c[i + 1]) * x + D(c[i]); };
  const auto quad = [&](int i) { return pair(i + 2) * x2 + pair(i); };
  return (quad(12) * x4 + quad(8)) * x8 + (quad(4) * x4 + quad(0));
}

/// 2^x; overflows to infinity, underflows gradually. NaN gives NaN.
template <class D>
OKTETT_INLINE D exp2(const D& x) {
  static constexpr double kTaylor[16] = {1,
                                         1,
                                         1 / 2.0,
                                         1 / 6.0,
                                         1 / 24.0,
                                         1 / 120.0,
                                         1 / 720.0,
                                         1 / 5040.0,
                                         1 / 40320.0,
                                         1 / 362880.0,
                                         1 / 3628800.0,
                                         1 / 39916800.0,
                                         1 / 479001600.0,
                                         1 / 6227020800.0,
                                         1 / 87178291200.0,
                                         0};
  const D clamped = min(D(1100.0), max(D(-1100.0), x));
  const D whole = round_even(clamped);
  const D fraction = estrin16(kTaylor, (clamped - whole) * D(std::numbers::ln2));
  // In two steps, as 2^n alone may be out of range where the product is not.
  const D half = round_even(whole * D(0.5));
  return fraction * power_of_two(half) * power_of_two(whole - half);
}

/// ln m where x = m 2^exponent, m in [sqrt(1/2), sqrt(2)], for finite x > 0.
template <class D>
OKTETT_INLINE D log_significand(const D& x, D& exponent) {
  // 2 atanh(s) / s as a series in s^2, where s = (m - 1) / (m + 1), |s| < 0.1716.
  static constexpr double kSeries[] = {2 / 23.0, 2 / 21.0, 2 / 19.0, 2 / 17.0, 2 / 15.0, 2 / 13.0,
                                       2 / 11.0, 2 / 9.0,  2 / 7.0,  2 / 5.0,  2 / 3.0,  2};
  const auto small = x < D(std::numeric_limits<double>::min());
  D m = split_exponent(select(small, x * D(0x1p54), x), exponent);
  const auto upper = m > D(std::numbers::sqrt2);
  m = select(upper, m * D(0.5), m);
  exponent = exponent + select(upper, D(1.0), D(0.0)) - select(small, D(54.0), D(0.0));
  const D s = (m - D(1.0)) / (m + D(1.0)), s2 = s * s, s4 = s2 * s2, s8 = s4 * s4;
  const auto pair = [&](int i) { return D(kSeries[11 - i - 1]) * s2 + D(kSeries[11 - i]); };
  const D high = pair(10) * s4 + pair(8), middle = pair(6) * s4 + pair(4), low = pair(2) * s4 + pair(0);
  return s * ((high * s8 + middle) * s8 + low);
}

/// The limits of logarithms: -infinity at 0, infinity at infinity, NaN below 0 and at NaN.
template <class D>
OKTETT_INLINE D limits_of_log(const D& x, const D& log) {
  const D inf(std::numeric_limits<double>::infinity());
  const D special =
      select(x == D(0.0), -inf, select(x == inf, inf, D(std::numeric_limits<double>::quiet_NaN())));
  return select((x > D(0.0)) & (x < inf), log, special);
}
template <class D>
OKTETT_INLINE D log2(const D& x) {
  D exponent;
  const D m = log_significand(x, exponent);
  return limits_of_log(x, exponent + m * D(std::numbers::log2e));
}
template <class D>
OKTETT_INLINE D log(const D& x) {
  D exponent;
  const D m = log_significand(x, exponent);
  return limits_of_log(x, exponent * D(std::numbers::ln2) + m);
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

/// x^n for whole n >= 1 by squaring; relative error below n 2^-53 (1 + n 2^-53).
template <class D>
OKTETT_INLINE D pow_whole(D x, int n) {
  while (n % 2 == 0) x = x * x, n /= 2;
  D r = x;
  for (n /= 2; n > 0; n /= 2) {
    x = x * x;
    if (n % 2 == 1) r = r * x;
  }
  return r;
}

/// Sine and cosine of x radians, |x| <= kMaxAngle.
template <class D>
OKTETT_INLINE void sin_cos(const D& x, D& sin, D& cos) {
  // pi/2 in three parts of 33 bits: k times a part is exact for k < 2^20 (Cody and Waite 1980).
  const D k = round_even(x * D(2 / std::numbers::pi));
  const D r = ((x - k * D(1.57079632673412561417e+00)) - k * D(6.07710050630396597660e-11)) -
              k * D(2.02226624871116645580e-21);
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
