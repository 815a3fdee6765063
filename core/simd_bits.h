#pragma once
/// \file Exponents and significands of doubles in lanes, exactly, for elementary functions.

#include <bit>
#include <cstdint>

#include "core/simd.h"

namespace oktett {

namespace native {

template <class A>
OKTETT_INLINE Lane<double, A> low_bits_to_exponent(Lane<double, A> a) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(a.v) << 52);
}
template <class A>
OKTETT_INLINE Lane<double, A> biased_exponent(Lane<double, A> a) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(a.v) >> 52 | 0x4330000000000000u) - 0x1p52;
}
template <class A>
OKTETT_INLINE Lane<double, A> significand(Lane<double, A> a) {
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(a.v) & 0x000fffffffffffffu) |
                               0x3ff0000000000000u);
}

#if defined(OKTETT_COMPILED_SSE42)
OKTETT_INLINE batch<double, Sse> low_bits_to_exponent(batch<double, Sse> a) {
  return _mm_castsi128_pd(_mm_slli_epi64(_mm_castpd_si128(a), 52));
}
OKTETT_INLINE batch<double, Sse> biased_exponent(batch<double, Sse> a) {
  const __m128i whole =
      _mm_or_si128(_mm_srli_epi64(_mm_castpd_si128(a), 52), _mm_castpd_si128(_mm_set1_pd(0x1p52)));
  return _mm_sub_pd(_mm_castsi128_pd(whole), _mm_set1_pd(0x1p52));
}
OKTETT_INLINE batch<double, Sse> significand(batch<double, Sse> a) {
  const __m128i low = _mm_and_si128(_mm_castpd_si128(a), _mm_set1_epi64x(0x000fffffffffffff));
  return _mm_castsi128_pd(_mm_or_si128(low, _mm_castpd_si128(_mm_set1_pd(1.0))));
}
#endif
#if defined(OKTETT_COMPILED_AVX2)
OKTETT_INLINE batch<double, Avx> low_bits_to_exponent(batch<double, Avx> a) {
  return _mm256_castsi256_pd(_mm256_slli_epi64(_mm256_castpd_si256(a), 52));
}
OKTETT_INLINE batch<double, Avx> biased_exponent(batch<double, Avx> a) {
  const __m256i whole = _mm256_or_si256(_mm256_srli_epi64(_mm256_castpd_si256(a), 52),
                                        _mm256_castpd_si256(_mm256_set1_pd(0x1p52)));
  return _mm256_sub_pd(_mm256_castsi256_pd(whole), _mm256_set1_pd(0x1p52));
}
OKTETT_INLINE batch<double, Avx> significand(batch<double, Avx> a) {
  const __m256i low = _mm256_and_si256(_mm256_castpd_si256(a), _mm256_set1_epi64x(0x000fffffffffffff));
  return _mm256_castsi256_pd(_mm256_or_si256(low, _mm256_castpd_si256(_mm256_set1_pd(1.0))));
}
#endif
#if defined(OKTETT_COMPILED_AVX512)
OKTETT_INLINE batch<double, Avx5> low_bits_to_exponent(batch<double, Avx5> a) {
  return _mm512_castsi512_pd(_mm512_slli_epi64(_mm512_castpd_si512(a), 52));
}
OKTETT_INLINE batch<double, Avx5> biased_exponent(batch<double, Avx5> a) {
  const __m512i whole = _mm512_or_si512(_mm512_srli_epi64(_mm512_castpd_si512(a), 52),
                                        _mm512_castpd_si512(_mm512_set1_pd(0x1p52)));
  return _mm512_sub_pd(_mm512_castsi512_pd(whole), _mm512_set1_pd(0x1p52));
}
OKTETT_INLINE batch<double, Avx5> significand(batch<double, Avx5> a) {
  const __m512i low = _mm512_and_si512(_mm512_castpd_si512(a), _mm512_set1_epi64(0x000fffffffffffff));
  return _mm512_castsi512_pd(_mm512_or_si512(low, _mm512_castpd_si512(_mm512_set1_pd(1.0))));
}
#endif
#if defined(OKTETT_COMPILED_NEON)
OKTETT_INLINE NeonDouble low_bits_to_exponent(NeonDouble a) {
  return vreinterpretq_f64_u64(vshlq_n_u64(vreinterpretq_u64_f64(a), 52));
}
OKTETT_INLINE NeonDouble biased_exponent(NeonDouble a) {
  return vcvtq_f64_u64(vshrq_n_u64(vreinterpretq_u64_f64(a), 52));
}
OKTETT_INLINE NeonDouble significand(NeonDouble a) {
  const uint64x2_t low = vandq_u64(vreinterpretq_u64_f64(a), vdupq_n_u64(0x000fffffffffffff));
  return vreinterpretq_f64_u64(vorrq_u64(low, vdupq_n_u64(0x3ff0000000000000)));
}
#endif

}  // namespace native

/// 2^n for whole n, -1022 <= n <= 1023.
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> power_of_two(const Simd<double, W, A>& n) {
  const auto shifted = n + Simd<double, W, A>(0x1p52 + 1023);
  Simd<double, W, A> r;
  for (int i = 0; i < r.kParts; ++i) r.part[i] = native::low_bits_to_exponent(shifted.part[i]);
  return r;
}

/// For finite x >= 2^-1022: x = significand 2^exponent with 1 <= significand < 2; returns the significand.
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> split_exponent(const Simd<double, W, A>& x, Simd<double, W, A>& exponent) {
  Simd<double, W, A> r;
  for (int i = 0; i < r.kParts; ++i) {
    exponent.part[i] = native::biased_exponent(x.part[i]);
    r.part[i] = native::significand(x.part[i]);
  }
  exponent = exponent - Simd<double, W, A>(1023.0);
  return r;
}

}  // namespace oktett
