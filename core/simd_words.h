#pragma once
/// \file Sixteen 16-bit numbers as sixteen floats.

#include <cstdint>

#include "core/simd.h"

namespace oktett {

/// The 16 numbers from `p` on.
template <class A>
OKTETT_INLINE Simd<float, 16, A> load_words(const std::uint16_t* p) {
#if defined(OKTETT_COMPILED_SSE42)
  if constexpr (!std::is_same_v<A, ScalarIsa>) {
    Simd<float, 16, A> r;
    const auto* words = reinterpret_cast<const __m128i*>(p);
#if defined(OKTETT_COMPILED_AVX512)
    if constexpr (r.kParts == 1) {
      r.part[0] =
          _mm512_cvtepi32_ps(_mm512_cvtepu16_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))));
      return r;
    }
#endif
#if defined(OKTETT_COMPILED_AVX2)
    if constexpr (r.kParts == 2) {
      for (int i = 0; i < 2; ++i)
        r.part[i] = _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(_mm_loadu_si128(words + i)));
      return r;
    }
#endif
    if constexpr (r.kParts == 4) {
      for (int i = 0; i < 2; ++i) {
        const __m128i eight = _mm_loadu_si128(words + i);
        r.part[2 * i] = _mm_cvtepi32_ps(_mm_cvtepu16_epi32(eight));
        r.part[2 * i + 1] = _mm_cvtepi32_ps(_mm_cvtepu16_epi32(_mm_srli_si128(eight, 8)));
      }
      return r;
    }
  }
#endif
  alignas(64) float lanes[16];
  for (int i = 0; i < 16; ++i) lanes[i] = static_cast<float>(p[i]);
  return Simd<float, 16, A>::load(lanes);
}

}  // namespace oktett
