#pragma once
/// \file Sixteen 16-bit numbers as sixteen floats.

#include <cstdint>

#include "core/simd.h"

namespace oktett {

/// Number k of the result is p[k ^ flip], flip < 16.
template <class A>
OKTETT_INLINE Simd<float, 16, A> load_words(const std::uint16_t* p, unsigned flip = 0) {
#if defined(OKTETT_COMPILED_SSE42)
  if constexpr (!std::is_same_v<A, ScalarIsa>) {
    Simd<float, 16, A> r;
#if defined(OKTETT_COMPILED_AVX512)
    if constexpr (r.kParts == 1) {
      const __m256i order =
          _mm256_xor_si256(_mm256_setr_epi16(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
                           _mm256_set1_epi16(static_cast<short>(flip)));
      const __m256i words =
          _mm256_permutexvar_epi16(order, _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)));
      r.part[0] = _mm512_cvtepi32_ps(_mm512_cvtepu16_epi32(words));
      return r;
    }
#endif
    // Bit 3 of `flip` exchanges the halves; the other bits exchange words, pairs of bytes, within each half.
    const __m128i order = _mm_xor_si128(_mm_setr_epi8(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
                                        _mm_set1_epi8(static_cast<char>(2 * (flip & 7))));
    const auto eight = [&](unsigned half) {
      const auto* words = reinterpret_cast<const __m128i*>(p) + (half ^ flip >> 3);
      return _mm_shuffle_epi8(_mm_loadu_si128(words), order);
    };
#if defined(OKTETT_COMPILED_AVX2)
    if constexpr (r.kParts == 2) {
      for (unsigned i = 0; i < 2; ++i) r.part[i] = _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(eight(i)));
      return r;
    }
#endif
    if constexpr (r.kParts == 4) {
      for (unsigned i = 0; i < 2; ++i) {
        const __m128i words = eight(i);
        r.part[2 * i] = _mm_cvtepi32_ps(_mm_cvtepu16_epi32(words));
        r.part[2 * i + 1] = _mm_cvtepi32_ps(_mm_cvtepu16_epi32(_mm_srli_si128(words, 8)));
      }
      return r;
    }
  }
#elif defined(OKTETT_COMPILED_NEON)
  if constexpr (std::is_same_v<A, NeonIsa>) {
    // Bit 3 of `flip` exchanges the halves; the other bits exchange words, pairs of bytes, within each half.
    const uint8x16_t order = veorq_u8(uint8x16_t{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
                                      vdupq_n_u8(static_cast<std::uint8_t>(2 * (flip & 7))));
    Simd<float, 16, A> r;
    for (unsigned half = 0; half < 2; ++half) {
      const uint8x16_t bytes = vreinterpretq_u8_u16(vld1q_u16(p + 8 * (half ^ flip >> 3)));
      const uint16x8_t words = vreinterpretq_u16_u8(vqtbl1q_u8(bytes, order));
      r.part[2 * half] = vcvtq_f32_u32(vmovl_u16(vget_low_u16(words)));
      r.part[2 * half + 1] = vcvtq_f32_u32(vmovl_high_u16(words));
    }
    return r;
  }
#endif
  alignas(64) float lanes[16];
  for (unsigned i = 0; i < 16; ++i) lanes[i] = static_cast<float>(p[i ^ flip]);
  return Simd<float, 16, A>::load(lanes);
}

}  // namespace oktett
