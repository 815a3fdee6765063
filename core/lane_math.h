#pragma once
/// \file Elementary functions of doubles in lanes, with the same bits in every width and instruction set.

#include <numbers>

#include "core/lanes.h"

namespace oktett {

/// `x` within [least, most]; `least` for NaN.
template <class D>
OKTETT_INLINE D within(const D& x, const D& least, const D& most) {
  return min(max(x, least), most);
}

/// The greatest whole number up to `x`, 0 <= x < 2^51.
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> whole_part(const Simd<double, W, A>& x) {
  using D = Simd<double, W, A>;
  const D nearest = (x + D(0x1p52)) - D(0x1p52);
  return select(nearest > x, nearest - D(1.0), nearest);
}

/// Horner's scheme; `c` from the highest power down.
template <class D, std::size_t N>
OKTETT_INLINE D polynomial_lanes(const double (&c)[N], const D& x) {
  D sum(c[0]);
  for (std::size_t i = 1; i < N; ++i) sum = sum * x + D(c[i]);
  return sum;
}

/// Sine and cosine of `turn` times a full circle, 0 <= turn <= 1. The absolute error is below 1e-15.
template <int W, class A>
OKTETT_INLINE void sin_cos_of_turn(const Simd<double, W, A>& turn, Simd<double, W, A>& sine,
                                   Simd<double, W, A>& cosine) {
  using D = Simd<double, W, A>;
  // Taylor's series, for angles up to pi/4.
  constexpr double kSine[] = {-1 / 1307674368000.0, 1 / 6227020800.0, -1 / 39916800.0, 1 / 362880.0,
                              -1 / 5040.0,          1 / 120.0,        -1 / 6.0};
  constexpr double kCosine[] = {1 / 20922789888000.0,
                                -1 / 87178291200.0,
                                1 / 479001600.0,
                                -1 / 3628800.0,
                                1 / 40320.0,
                                -1 / 720.0,
                                1 / 24.0,
                                -1 / 2.0,
                                1};
  const D quarters = turn * D(4.0), quadrant = whole_part(quarters + D(0.5));
  const D angle = (quarters - quadrant) * D(std::numbers::pi / 2), square = angle * angle;
  const D s = angle + angle * (square * polynomial_lanes(kSine, square));
  const D c = polynomial_lanes(kCosine, square);
  const auto first = quadrant == D(1.0), second = quadrant == D(2.0), third = quadrant == D(3.0);
  const auto odd = first | third;
  const D along = select(odd, s, c), across = select(odd, c, s);
  cosine = select(first | second, -along, along);
  sine = select(second | third, -across, across);
}

/// The angle whose tangent is `x`, 0 <= x <= 1.
template <class D>
OKTETT_INLINE D atan_unit(D x) {
  static constexpr double kSeries[] = {1 / 25.0,  -1 / 23.0, 1 / 21.0,  -1 / 19.0, 1 / 17.0,
                                       -1 / 15.0, 1 / 13.0,  -1 / 11.0, 1 / 9.0,   -1 / 7.0,
                                       1 / 5.0,   -1 / 3.0,  1};
  // atan x = 2 atan(x / (1 + sqrt(1 + x^2))), twice: x falls below tan(pi/16).
  for (int i = 0; i < 2; ++i) x = x / (D(1.0) + sqrt(D(1.0) + x * x));
  return D(4.0) * x * polynomial_lanes(kSeries, x * x);
}

/// Lanes whose sign bit is set.
template <class D>
OKTETT_INLINE typename D::M is_negative(const D& x) {
  const D zero(0.0);
  return (x < zero) | ((x == zero) & (D(1.0) / x < zero));
}

/// portable::atan2 in lanes, with the same bits, for finite numbers.
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

/// portable::asin in lanes, with the same bits, for numbers from -1 to 1.
template <class D>
OKTETT_INLINE D asin_lanes(const D& x) {
  const D one(1.0);
  return atan2_lanes(x, sqrt((one - x) * (one + x)));
}

/// make_basis in lanes. At n.z = -0 the sign is 1.
template <class D>
OKTETT_INLINE void basis_lanes(const Vec3<D>& n, Vec3<D>& tangent, Vec3<D>& bitangent) {
  const D one(1), sign = select(n.z < D(0), -one, one);
  const D a = -one / (sign + n.z), b = n.x * n.y * a;
  tangent = {one + sign * n.x * n.x * a, sign * b, -sign * n.x};
  bitangent = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace oktett
