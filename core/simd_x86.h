#pragma once
/// \file x86 operations on single registers for core/simd_native.h: minimum and maximum with a fixed NaN
/// rule, fused multiply-add, masks as bits, conversions, gathers. Included by core/simd_native.h alone.

#include <immintrin.h>

namespace oktett::native {

using xsimd::batch;
using xsimd::batch_bool;
using Sse = xsimd::sse4_2;

// Operations whose names differ only by the size of the registers: `mm` begins those of the processor,
// `whole` ends those of whole numbers, and `bits64` ends the one that fills a register with a number of 64
// bits.
//
// min(a, b) is a < b ? a : b and max(a, b) is a > b ? a : b, hence b if either is NaN: pass the accumulator
// second.
#define OKTETT_IN_REGISTERS(A, mm, whole, bits64)                                                          \
  OKTETT_INLINE batch<float, A> min(batch<float, A> a, batch<float, A> b) { return mm##_min_ps(a, b); }    \
  OKTETT_INLINE batch<float, A> max(batch<float, A> a, batch<float, A> b) { return mm##_max_ps(a, b); }    \
  OKTETT_INLINE batch<double, A> min(batch<double, A> a, batch<double, A> b) { return mm##_min_pd(a, b); } \
  OKTETT_INLINE batch<double, A> max(batch<double, A> a, batch<double, A> b) { return mm##_max_pd(a, b); } \
  OKTETT_INLINE batch<float, A> bit_cast_float(batch<std::int32_t, A> a) {                                 \
    return mm##_cast##whole##_ps(a);                                                                       \
  }                                                                                                        \
  OKTETT_INLINE batch<std::int32_t, A> bit_cast_int(batch<float, A> a) { return mm##_castps_##whole(a); }  \
  OKTETT_INLINE batch<double, A> low_bits_to_exponent(batch<double, A> a) {                                \
    return mm##_cast##whole##_pd(mm##_slli_epi64(mm##_castpd_##whole(a), 52));                             \
  }                                                                                                        \
  OKTETT_INLINE batch<double, A> biased_exponent(batch<double, A> a) {                                     \
    const auto exponent = mm##_srli_epi64(mm##_castpd_##whole(a), 52);                                     \
    const auto number = mm##_or_##whole(exponent, mm##_castpd_##whole(mm##_set1_pd(0x1p52)));              \
    return mm##_sub_pd(mm##_cast##whole##_pd(number), mm##_set1_pd(0x1p52));                               \
  }                                                                                                        \
  OKTETT_INLINE batch<double, A> significand(batch<double, A> a) {                                         \
    const auto low = mm##_and_##whole(mm##_castpd_##whole(a), mm##_set1_##bits64(0x000fffffffffffff));     \
    return mm##_cast##whole##_pd(mm##_or_##whole(low, mm##_castpd_##whole(mm##_set1_pd(1.0))));            \
  }
#define OKTETT_FUSED(T, A, mm, p)                                              \
  OKTETT_INLINE batch<T, A> fma(batch<T, A> a, batch<T, A> b, batch<T, A> c) { \
    return mm##_fmadd_##p(a, b, c);                                            \
  }                                                                            \
  OKTETT_INLINE batch<T, A> fms(batch<T, A> a, batch<T, A> b, batch<T, A> c) { \
    return mm##_fmsub_##p(a, b, c);                                            \
  }

OKTETT_IN_REGISTERS(Sse, _mm, si128, epi64x)

OKTETT_INLINE void set_four(batch<float, Sse>& r, float x, float y, float z, float w) {
  r = _mm_setr_ps(x, y, z, w);
}

OKTETT_INLINE unsigned bits(batch_bool<float, Sse> m) { return static_cast<unsigned>(_mm_movemask_ps(m)); }
OKTETT_INLINE unsigned bits(batch_bool<double, Sse> m) { return static_cast<unsigned>(_mm_movemask_pd(m)); }
OKTETT_INLINE unsigned bits(batch_bool<std::int32_t, Sse> m) {
  return static_cast<unsigned>(_mm_movemask_ps(_mm_castsi128_ps(m)));
}
OKTETT_INLINE __m128i expand_bits4(unsigned b) {
  const __m128i lane = _mm_setr_epi32(1, 2, 4, 8);
  return _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(static_cast<int>(b)), lane), lane);
}
OKTETT_INLINE void from_bits(batch_bool<float, Sse>& m, unsigned b) { m = _mm_castsi128_ps(expand_bits4(b)); }
OKTETT_INLINE void from_bits(batch_bool<std::int32_t, Sse>& m, unsigned b) { m = expand_bits4(b); }
OKTETT_INLINE void from_bits(batch_bool<double, Sse>& m, unsigned b) {
  const __m128i lane = _mm_set_epi64x(2, 1);
  m = _mm_castsi128_pd(_mm_cmpeq_epi64(_mm_and_si128(_mm_set1_epi64x(b), lane), lane));
}

/// See Simd's transpose3.
OKTETT_INLINE void transpose3(batch<float, Sse>& a, batch<float, Sse>& b, batch<float, Sse>& c) {
  const __m128 xy = _mm_unpacklo_ps(a, b), z = _mm_unpackhi_ps(a, b);
  a = _mm_movelh_ps(xy, c);
  b = _mm_shuffle_ps(xy, c, _MM_SHUFFLE(1, 1, 3, 2));
  c = _mm_shuffle_ps(z, c, _MM_SHUFFLE(2, 2, 1, 0));
}

/// Four floats to two registers of two doubles, and back.
OKTETT_INLINE void widen(batch<float, Sse> a, batch<double, Sse>& lo, batch<double, Sse>& hi) {
  lo = _mm_cvtps_pd(a), hi = _mm_cvtps_pd(_mm_movehl_ps(a, a));
}
OKTETT_INLINE batch<float, Sse> narrow(batch<double, Sse> lo, batch<double, Sse> hi) {
  return _mm_movelh_ps(_mm_cvtpd_ps(lo), _mm_cvtpd_ps(hi));
}
/// Least lane.
OKTETT_INLINE float reduce_min(batch<float, Sse> a) {
  const __m128 pairs = _mm_min_ps(a, _mm_movehl_ps(a, a));
  return _mm_cvtss_f32(_mm_min_ss(pairs, _mm_shuffle_ps(pairs, pairs, 1)));
}

#if defined(OKTETT_COMPILED_AVX2)
using Avx = XsimdAvx2;
OKTETT_IN_REGISTERS(Avx, _mm256, si256, epi64x)
OKTETT_FUSED(float, Sse, _mm, ps)
OKTETT_FUSED(double, Sse, _mm, pd)
OKTETT_FUSED(float, Avx, _mm256, ps)
OKTETT_FUSED(double, Avx, _mm256, pd)

OKTETT_INLINE unsigned bits(batch_bool<float, Avx> m) { return static_cast<unsigned>(_mm256_movemask_ps(m)); }
OKTETT_INLINE unsigned bits(batch_bool<double, Avx> m) {
  return static_cast<unsigned>(_mm256_movemask_pd(m));
}
OKTETT_INLINE unsigned bits(batch_bool<std::int32_t, Avx> m) {
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(m)));
}
OKTETT_INLINE __m256i expand_bits8(unsigned b) {
#if defined(OKTETT_COMPILED_AVX512)
  return _mm256_movm_epi32(static_cast<__mmask8>(b));
#else
  const __m256i lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  return _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(static_cast<int>(b)), lane), lane);
#endif
}
OKTETT_INLINE void from_bits(batch_bool<float, Avx>& m, unsigned b) {
  m = _mm256_castsi256_ps(expand_bits8(b));
}
OKTETT_INLINE void from_bits(batch_bool<std::int32_t, Avx>& m, unsigned b) { m = expand_bits8(b); }
OKTETT_INLINE void from_bits(batch_bool<double, Avx>& m, unsigned b) {
  const __m256i lane = _mm256_set_epi64x(8, 4, 2, 1);
  m = _mm256_castsi256_pd(_mm256_cmpeq_epi64(_mm256_and_si256(_mm256_set1_epi64x(b), lane), lane));
}

OKTETT_INLINE void load_front(batch<float, Avx>& r, const float* p, int count, float rest) {
  const __m256i present =
      _mm256_cmpgt_epi32(_mm256_set1_epi32(count), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
  r = _mm256_blendv_ps(_mm256_set1_ps(rest), _mm256_maskload_ps(p, present), _mm256_castsi256_ps(present));
}
OKTETT_INLINE void widen(batch<float, Sse> a, batch<double, Avx>& r) { r = _mm256_cvtps_pd(a); }
OKTETT_INLINE batch<float, Sse> narrow(batch<double, Avx> a) { return _mm256_cvtpd_ps(a); }
OKTETT_INLINE void widen(batch<float, Avx> a, batch<double, Avx>& lo, batch<double, Avx>& hi) {
  lo = _mm256_cvtps_pd(_mm256_castps256_ps128(a)), hi = _mm256_cvtps_pd(_mm256_extractf128_ps(a, 1));
}
OKTETT_INLINE batch<float, Avx> narrow(batch<double, Avx> lo, batch<double, Avx> hi) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(lo)), _mm256_cvtpd_ps(hi), 1);
}
OKTETT_INLINE float reduce_min(batch<float, Avx> a) {
  return reduce_min(batch<float, Sse>(_mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1))));
}
#endif

#if defined(OKTETT_COMPILED_AVX512)
using Avx5 = xsimd::avx512bw;
OKTETT_IN_REGISTERS(Avx5, _mm512, si512, epi64)
OKTETT_FUSED(float, Avx5, _mm512, ps)
OKTETT_FUSED(double, Avx5, _mm512, pd)

OKTETT_INLINE unsigned bits(batch_bool<float, Avx5> m) { return m.data; }
OKTETT_INLINE unsigned bits(batch_bool<double, Avx5> m) { return m.data; }
OKTETT_INLINE unsigned bits(batch_bool<std::int32_t, Avx5> m) { return m.data; }
OKTETT_INLINE void from_bits(batch_bool<float, Avx5>& m, unsigned b) { m = static_cast<__mmask16>(b); }
OKTETT_INLINE void from_bits(batch_bool<double, Avx5>& m, unsigned b) { m = static_cast<__mmask8>(b); }
OKTETT_INLINE void from_bits(batch_bool<std::int32_t, Avx5>& m, unsigned b) { m = static_cast<__mmask16>(b); }

OKTETT_INLINE void load_front(batch<float, Avx5>& r, const float* p, int count, float rest) {
  r = _mm512_mask_loadu_ps(_mm512_set1_ps(rest), static_cast<__mmask16>((1u << count) - 1), p);
}
OKTETT_INLINE void widen(batch<float, Avx> a, batch<double, Avx5>& r) { r = _mm512_cvtps_pd(a); }
OKTETT_INLINE batch<float, Avx> narrow(batch<double, Avx5> a) { return _mm512_cvtpd_ps(a); }
OKTETT_INLINE void widen(batch<float, Avx5> a, batch<double, Avx5>& lo, batch<double, Avx5>& hi) {
  lo = _mm512_cvtps_pd(_mm512_castps512_ps256(a)), hi = _mm512_cvtps_pd(_mm512_extractf32x8_ps(a, 1));
}
OKTETT_INLINE batch<float, Avx5> narrow(batch<double, Avx5> lo, batch<double, Avx5> hi) {
  return _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(lo)), _mm512_cvtpd_ps(hi), 1);
}
OKTETT_INLINE float reduce_min(batch<float, Avx5> a) {
  return reduce_min(
      batch<float, Avx>(_mm256_min_ps(_mm512_castps512_ps256(a), _mm512_extractf32x8_ps(a, 1))));
}
OKTETT_INLINE batch<float, Avx5> concat(batch<float, Avx> lo, batch<float, Avx> hi) {
  return _mm512_insertf32x8(_mm512_castps256_ps512(lo), hi, 1);
}
#endif
#undef OKTETT_IN_REGISTERS
#undef OKTETT_FUSED

}  // namespace oktett::native
