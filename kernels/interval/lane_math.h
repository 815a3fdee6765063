#pragma once
/// \file Elementary functions in lanes of double: fixed operations, so that a lane has the same bits in every
/// width and instruction set. Relative errors are below kLaneMathError.

#include <bit>
#include <cstdint>

#include "core/simd.h"

namespace oktett {

/// Bound on the relative error of exp2_lanes and pow_lanes, and on the absolute one of log2_lanes relative to
/// 1 + |log2 x|.
inline constexpr double kLaneMathError = 0x1p-40;

/// 2^x for finite x: 0 below -1000, infinity above 1000. NaN gives anything.
template <class D>
OKTETT_INLINE D exp2_lanes(const D& x) {
  constexpr int W = D::kWidth;
  const D limited = max(min(x, D(1001.0)), D(-1001.0));
  // Adding this rounds to a whole number, which then stands in the low bits.
  const D magic(0x1.8p52);
  const D shifted = limited + magic, whole = shifted - magic;
  const D r = (limited - whole) * D(0.693147180559945309417232);
  // Taylor: |r| < 0.347, so the first term left out is below 2^-46.
  D y(1.0 / 479001600);
  for (const double c : {1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320, 1.0 / 5040, 1.0 / 720, 1.0 / 120,
                         1.0 / 24, 1.0 / 6, 0.5, 1.0, 1.0})
    y = y * r + D(c);
  double n[W], scale[W];
  shifted.store(n);
  for (int i = 0; i < W; ++i)
    scale[i] = std::bit_cast<double>((std::bit_cast<std::uint64_t>(n[i]) + 1023) << 52);
  y = y * D::load(scale);
  return select(x < D(-1000.0), D(0.0), select(x > D(1000.0), D(__builtin_huge_val()), y));
}

/// log2 x for normal x > 0; -infinity for 0 and below, infinity for infinity.
template <class D>
OKTETT_INLINE D log2_lanes(const D& x) {
  constexpr int W = D::kWidth;
  double v[W], e[W], m[W];
  x.store(v);
  for (int i = 0; i < W; ++i) {
    // Mantissas lie in [sqrt(1/2), sqrt(2)): the offset makes the exponent round so.
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(v[i]), moved = bits - 0x3fe6a09e667f3bcdull;
    const std::uint64_t exponent = (moved >> 52) + 0;
    m[i] = std::bit_cast<double>(bits - (exponent << 52));
    // A signed number of 12 bits, as a double.
    e[i] = static_cast<double>(static_cast<std::int32_t>(static_cast<std::uint32_t>(exponent) << 20) >> 20);
  }
  const D mantissa = D::load(m), s = (mantissa - D(1.0)) / (mantissa + D(1.0)), ss = s * s;
  D y(2.0 / 19);
  for (const double c : {2.0 / 17, 2.0 / 15, 2.0 / 13, 2.0 / 11, 2.0 / 9, 2.0 / 7, 2.0 / 5, 2.0 / 3, 2.0})
    y = y * ss + D(c);
  const D result = D::load(e) + s * y * D(1.44269504088896340736);
  const D inf(__builtin_huge_val());
  return select(x < D(0x1p-1022), -inf, select(x < inf, result, inf));
}

/// x^p for x >= 0 and p > 0: by repeated squaring for small whole p, else by logarithms.
template <class D>
OKTETT_INLINE D pow_lanes(const D& x, double p) {
  if (p == 1) return x;
  if (p == 2) return x * x;
  if (p <= 64 && p == static_cast<int>(p)) {
    D result(1.0), power = x;
    for (int n = static_cast<int>(p); n != 0; n >>= 1, power = power * power)
      if ((n & 1) != 0) result = result * power;
    return result;
  }
  return select(x > D(0.0), exp2_lanes(D(p) * log2_lanes(x)), D(0.0));
}

}  // namespace oktett
