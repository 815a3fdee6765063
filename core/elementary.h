#pragma once
/// \file Elementary functions of doubles in lanes, from + - * / and sqrt in a fixed order, so that every
/// width and instruction set gives the same bits; those of core/math.h are these with one lane.

#include <cstddef>
#include <iterator>
#include <limits>
#include <numbers>

#include "core/lanes.h"

namespace oktett {

/// The greatest whole number up to `x`, 0 <= x < 2^51.
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> whole_part(const Simd<double, W, A>& x) {
  using D = Simd<double, W, A>;
  const D nearest = (x + D(0x1p52)) - D(0x1p52);
  return select(nearest > x, nearest - D(1.0), nearest);
}

/// Nearest whole number for |x| < 2^51, halves to even.
template <class D>
OKTETT_INLINE D round_even(const D& x) {
  const D magic(0x1.8p52);
  return (x + magic) - magic;
}

/// Two ways to add up a polynomial, which differ in the last bits; `c` from the highest power down.
///
/// Horner's scheme has the fewest operations. Terms above those of c[kFirst] are left out.
struct Horner {
  template <std::size_t kFirst = 0, class D, std::size_t N>
  OKTETT_INLINE static D sum(const double (&c)[N], const D& x) {
    D sum(c[kFirst]);
    for (std::size_t i = kFirst + 1; i < N; ++i) sum = sum * x + D(c[i]);
    return sum;
  }
};
/// Estrin's scheme has shorter chains of operations that wait for each other. For nine to sixteen
/// coefficients.
struct Estrin {
  template <class D, std::size_t N>
  OKTETT_INLINE static D sum(const double (&c)[N], const D& x) {
    static_assert(N > 8 && N <= 16);
    const D x2 = x * x, x4 = x2 * x2;
    // Powers beyond the highest are never used; the index is kept in range for compilers that cannot tell.
    const auto of = [&](std::size_t power) { return D(c[power < N ? N - 1 - power : 0]); };
    const auto pair = [&](std::size_t i) { return i + 1 < N ? of(i + 1) * x + of(i) : of(i); };
    const auto quad = [&](std::size_t i) { return i + 2 < N ? pair(i + 2) * x2 + pair(i) : pair(i); };
    if constexpr (N > 12)
      return (quad(12) * x4 + quad(8)) * (x4 * x4) + (quad(4) * x4 + quad(0));
    else
      return (quad(8) * x4 + quad(4)) * x4 + quad(0);
  }
};

// ---- Powers and logarithms.

/// 2^x, where `whole` is a whole number next to `x`, at most 1100 in magnitude; overflows to infinity,
/// underflows gradually. The series is summed up by `Scheme`.
template <class Scheme, class D>
OKTETT_INLINE D exp2_near(const D& x, const D& whole) {
  static constexpr double kTaylor[] = {1 / 87178291200.0,
                                       1 / 6227020800.0,
                                       1 / 479001600.0,
                                       1 / 39916800.0,
                                       1 / 3628800.0,
                                       1 / 362880.0,
                                       1 / 40320.0,
                                       1 / 5040.0,
                                       1 / 720.0,
                                       1 / 120.0,
                                       1 / 24.0,
                                       1 / 6.0,
                                       1 / 2.0,
                                       1,
                                       1};
  const D fraction = Scheme::sum(kTaylor, (x - whole) * D(std::numbers::ln2));
  // In two steps, as 2^n alone may be out of range where the product is not.
  const D half = round_even(whole * D(0.5));
  return fraction * power_of_two(half) * power_of_two(whole - half);
}

/// ln m where x = m 2^exponent, m in [sqrt(1/2), sqrt(2)], for finite x > 0. `kHalvesRoot` tells whether
/// sqrt(2) itself is halved.
template <class Scheme, bool kHalvesRoot, class D>
OKTETT_INLINE D log_significand(const D& x, D& exponent) {
  // 2 atanh(s) / s as a series in s^2, where s = (m - 1) / (m + 1), |s| < 0.1716.
  static constexpr double kSeries[] = {2 / 23.0, 2 / 21.0, 2 / 19.0, 2 / 17.0, 2 / 15.0, 2 / 13.0,
                                       2 / 11.0, 2 / 9.0,  2 / 7.0,  2 / 5.0,  2 / 3.0,  2};
  const D root(std::numbers::sqrt2);
  const auto small = x < D(std::numeric_limits<double>::min());
  D m = split_exponent(select(small, x * D(0x1p54), x), exponent);
  const auto upper = kHalvesRoot ? m >= root : m > root;
  m = select(upper, m * D(0.5), m);
  exponent = exponent + select(upper, D(1.0), D(0.0)) - select(small, D(54.0), D(0.0));
  const D s = (m - D(1.0)) / (m + D(1.0));
  return s * Scheme::sum(kSeries, s * s);
}

/// The limits of logarithms: -infinity at 0, infinity at infinity, NaN below 0 and at NaN.
template <class D>
OKTETT_INLINE D limits_of_log(const D& x, const D& log) {
  const D inf(std::numeric_limits<double>::infinity());
  const D special =
      select(x == D(0.0), -inf, select(x == inf, inf, D(std::numeric_limits<double>::quiet_NaN())));
  return select((x > D(0.0)) & (x < inf), log, special);
}
template <class Scheme, bool kHalvesRoot, class D>
OKTETT_INLINE D log2_by(const D& x) {
  D exponent;
  const D m = log_significand<Scheme, kHalvesRoot>(x, exponent);
  return limits_of_log(x, exponent + m * D(std::numbers::log2e));
}
template <class Scheme, bool kHalvesRoot, class D>
OKTETT_INLINE D log_by(const D& x) {
  D exponent;
  const D m = log_significand<Scheme, kHalvesRoot>(x, exponent);
  return limits_of_log(x, exponent * D(std::numbers::ln2) + m);
}

/// x^n for whole n >= 1 by squaring; relative error below n 2^-53 (1 + n 2^-53).
template <class D>
OKTETT_INLINE D pow_whole(D x, unsigned n) {
  while (n % 2 == 0) x = x * x, n /= 2;
  D r = x;
  for (n /= 2; n > 0; n /= 2) {
    x = x * x;
    if (n % 2 == 1) r = r * x;
  }
  return r;
}

// ---- Sines and cosines.

/// x - quarters pi / 2 for whole numbers of quarter turns below 2^20.
template <class D>
OKTETT_INLINE D without_quarters(const D& x, const D& quarters) {
  // pi/2 in three parts of 33 bits: so their products are exact (Cody and Waite 1980).
  return ((x - quarters * D(1.57079632673412561417e+00)) - quarters * D(6.07710050630396597660e-11)) -
         quarters * D(2.02226624871116645580e-21);
}

/// The sine of an angle of up to an eighth of a turn, by the `kTerms` terms of Taylor's series behind the
/// first.
template <std::size_t kTerms = 8, class D>
OKTETT_INLINE D sin_of_eighth(const D& angle) {
  constexpr double kTaylor[] = {
      1 / 355687428096000.0, -1 / 1307674368000.0, 1 / 6227020800.0, -1 / 39916800.0,
      1 / 362880.0,          -1 / 5040.0,          1 / 120.0,        -1 / 6.0};
  const D square = angle * angle;
  return angle + angle * (square * Horner::sum<std::size(kTaylor) - kTerms>(kTaylor, square));
}

/// The cosine of such an angle, by `kTerms` terms.
template <std::size_t kTerms = 10, class D>
OKTETT_INLINE D cos_of_eighth(const D& angle) {
  constexpr double kTaylor[] = {-1 / 6402373705728000.0,
                                1 / 20922789888000.0,
                                -1 / 87178291200.0,
                                1 / 479001600.0,
                                -1 / 3628800.0,
                                1 / 40320.0,
                                -1 / 720.0,
                                1 / 24.0,
                                -1 / 2.0,
                                1};
  return Horner::sum<std::size(kTaylor) - kTerms>(kTaylor, angle * angle);
}

/// Sine and cosine of `turn` times a full circle, 0 <= turn <= 1. The absolute error is below 1e-15.
template <int W, class A>
OKTETT_INLINE void sin_cos_of_turn(const Simd<double, W, A>& turn, Simd<double, W, A>& sine,
                                   Simd<double, W, A>& cosine) {
  using D = Simd<double, W, A>;
  const D quarters = turn * D(4.0), quadrant = whole_part(quarters + D(0.5));
  const D angle = (quarters - quadrant) * D(std::numbers::pi / 2);
  const D s = sin_of_eighth<7>(angle), c = cos_of_eighth<9>(angle);
  const auto first = quadrant == D(1.0), second = quadrant == D(2.0), third = quadrant == D(3.0);
  const auto odd = first | third;
  const D along = select(odd, s, c), across = select(odd, c, s);
  cosine = select(first | second, -along, along);
  sine = select(second | third, -across, across);
}

// ---- Angles.

/// The angle whose tangent is `x`, 0 <= x <= 1.
template <class D>
OKTETT_INLINE D atan_unit(D x) {
  static constexpr double kSeries[] = {1 / 25.0,  -1 / 23.0, 1 / 21.0,  -1 / 19.0, 1 / 17.0,
                                       -1 / 15.0, 1 / 13.0,  -1 / 11.0, 1 / 9.0,   -1 / 7.0,
                                       1 / 5.0,   -1 / 3.0,  1};
  // atan x = 2 atan(x / (1 + sqrt(1 + x^2))), twice: x falls below tan(pi/16).
  for (int i = 0; i < 2; ++i) x = x / (D(1.0) + sqrt(D(1.0) + x * x));
  return D(4.0) * x * Horner::sum(kSeries, x * x);
}

/// Lanes whose sign bit is set.
template <class D>
OKTETT_INLINE typename D::M is_negative(const D& x) {
  const D zero(0.0);
  return (x < zero) | ((x == zero) & (D(1.0) / x < zero));
}

/// The angle of the point (x, y) in [-pi, pi]. For all numbers but NaN.
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> atan2_lanes(const Simd<double, W, A>& y, const Simd<double, W, A>& x) {
  using D = Simd<double, W, A>;
  const D zero(0.0), half_pi(std::numbers::pi / 2), ax = abs(x), ay = abs(y);
  const auto flat = ay < ax;
  const D unit = atan_unit(select(flat, ay, ax) / select(flat, ax, ay));
  D angle = select(flat, unit, half_pi - unit);
  angle = select(ax == ay, half_pi * D(0.5), angle);
  auto left = x < zero, below = y < zero;
  const auto at_zero = (x == zero) | (y == zero);
  if (any(at_zero)) {
    angle = select((x == zero) & (y == zero), zero, angle);
    left = is_negative(x), below = is_negative(y);
  }
  angle = select(left, D(std::numbers::pi) - angle, angle);
  return select(below, -angle, angle);
}

/// For numbers from -1 to 1.
template <class D>
OKTETT_INLINE D asin_lanes(const D& x) {
  const D one(1.0);
  return atan2_lanes(x, sqrt((one - x) * (one + x)));
}

}  // namespace oktett
