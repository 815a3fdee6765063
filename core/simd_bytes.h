#pragma once
/// \file Eight bytes as eight floats, and bytes as powers of two: what a node in bytes is made of.

#include <bit>
#include <cstdint>
#include <cstring>

#include "core/simd.h"

namespace oktett {

/// The eight bytes from `p` on as numbers.
template <class A>
OKTETT_INLINE Simd<float, 8, A> load_bytes(const std::uint8_t* p) {
#if defined(OKTETT_COMPILED_SSE42)
  if constexpr (!std::is_same_v<A, ScalarIsa>) {
    Simd<float, 8, A> r;
    const __m128i bytes = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(p));
#if defined(OKTETT_COMPILED_AVX2)
    if constexpr (kHasFma<A>) {
      r.part[0] = _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(bytes));
      return r;
    }
#endif
    if constexpr (r.kParts == 2) {
      r.part[0] = _mm_cvtepi32_ps(_mm_cvtepu8_epi32(bytes));
      r.part[1] = _mm_cvtepi32_ps(_mm_cvtepu8_epi32(_mm_srli_si128(bytes, 4)));
      return r;
    }
  }
#endif
  alignas(32) float lanes[8];
  for (int i = 0; i < 8; ++i) lanes[i] = static_cast<float>(p[i]);
  return Simd<float, 8, A>::load(lanes);
}

/// The floats whose exponent fields are the three bytes from `p` on (2^(byte - 127), or 0), and 0. Reads four
/// bytes.
template <class A>
OKTETT_INLINE Simd<float, 4, A> load_powers3(const std::uint8_t* p) {
  std::uint32_t word;
  std::memcpy(&word, p, sizeof word);
#if defined(OKTETT_COMPILED_SSE42)
  if constexpr (Simd<float, 4, A>::kParts == 1) {
    const __m128i bytes = _mm_cvtepu8_epi32(_mm_cvtsi32_si128(static_cast<int>(word & 0xffffff)));
    Simd<float, 4, A> r;
    r.part[0] = _mm_castsi128_ps(_mm_slli_epi32(bytes, 23));
    return r;
  }
#endif
  alignas(16) float lanes[4] = {};
  for (int i = 0; i < 3; ++i) lanes[i] = std::bit_cast<float>((word >> 8 * i & 0xff) << 23);
  return Simd<float, 4, A>::load(lanes);
}

/// Makes the compiler read `x` from memory again: where each element is to be spread over a vector, a load
/// does it for nothing, while taking a register apart keeps the one unit busy that moves lanes.
template <class T>
OKTETT_INLINE void reload(T& x) {
  asm volatile("" : "+m"(x));
}

}  // namespace oktett
