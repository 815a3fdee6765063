#pragma once
/// \file Floats as the integers of their bits: neighbours of floats, and digits of integers, in lanes.

#include <bit>
#include <cstdint>

#include "core/simd.h"

namespace oktett {

namespace native {

template <class A>
OKTETT_INLINE Lane<std::int32_t, A> bit_cast_int(Lane<float, A> a) {
  return std::bit_cast<std::int32_t>(a.v);
}
template <class A>
OKTETT_INLINE Lane<float, A> bit_cast_float(Lane<std::int32_t, A> a) {
  return std::bit_cast<float>(a.v);
}
template <class A>
OKTETT_INLINE Lane<std::int32_t, A> common_bits(Lane<std::int32_t, A> a, Lane<std::int32_t, A> b) {
  return a.v & b.v;
}
template <class X>
OKTETT_INLINE xsimd::batch<std::int32_t, X> common_bits(xsimd::batch<std::int32_t, X> a,
                                                        xsimd::batch<std::int32_t, X> b) {
  return a & b;
}

}  // namespace native

template <int W, class A>
OKTETT_INLINE Simd<std::int32_t, W, A> bit_cast_int(const Simd<float, W, A>& a) {
  Simd<std::int32_t, W, A> r;
  for (int i = 0; i < r.kParts; ++i) r.part[i] = native::bit_cast_int(a.part[i]);
  return r;
}
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> bit_cast_float(const Simd<std::int32_t, W, A>& a) {
  Simd<float, W, A> r;
  for (int i = 0; i < r.kParts; ++i) r.part[i] = native::bit_cast_float(a.part[i]);
  return r;
}

/// The lanes in which `a` and `bits` have a bit in common.
template <int W, class A>
OKTETT_INLINE Mask<std::int32_t, W, A> has_bits(const Simd<std::int32_t, W, A>& a, std::int32_t bits) {
  using I = Simd<std::int32_t, W, A>;
  const I wanted(bits);
  I common;
  for (int i = 0; i < a.kParts; ++i) common.part[i] = native::common_bits(a.part[i], wanted.part[i]);
  return ~(common == I(0));
}

/// The next float above `a` where `direction` > 0, the next below where it is < 0, and `a` where it is 0.
/// Beyond an infinity it stays; NaN stays NaN.
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> next_float(const Simd<float, W, A>& a, const Simd<float, W, A>& direction) {
  using I = Simd<std::int32_t, W, A>;
  const I zero(0), one(1), lowest(INT32_MIN), infinite(0x7f800000);
  // Numbers floats by their order, both zeros as 0; the same function leads back.
  const auto number = [&](const I& bits) { return select(bits < zero, lowest - bits, bits); };
  const I bits = bit_cast_int(a), place = number(bits), d = bit_cast_int(direction);
  const auto rises = (zero < d) & (place < infinite);
  const auto falls = (d < zero) & (lowest < d) & (-infinite < place);
  const I next = select(rises, place + one, place - one);
  return bit_cast_float(select(rises | falls, number(next), bits));
}

}  // namespace oktett
