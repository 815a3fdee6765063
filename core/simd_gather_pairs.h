#pragma once
/// \file Gathers of two elements that stand next to each other: one load fetches both.

#include <cstdint>

#include "core/simd.h"

namespace oktett {

namespace native {

template <class T, class B>
OKTETT_INLINE void gather_pairs(const T* base, const B& index, B& first, B& second) {
  double at[B::size], next[B::size];
  native::store(at, index);
  for (std::size_t i = 0; i < B::size; ++i) {
    const T* const pair = base + static_cast<std::int32_t>(at[i]);
    at[i] = static_cast<double>(pair[0]), next[i] = static_cast<double>(pair[1]);
  }
  native::load(first, at), native::load(second, next);
}
#if defined(OKTETT_COMPILED_AVX2)
OKTETT_INLINE void gather_pairs(const std::uint16_t* base, batch<double, Avx> index,
                                batch<double, Avx>& first, batch<double, Avx>& second) {
  const __m128i pairs =
      _mm_i32gather_epi32(reinterpret_cast<const int*>(base), _mm256_cvttpd_epi32(index), 2);
  first = _mm256_cvtepi32_pd(_mm_and_si128(pairs, _mm_set1_epi32(0xffff)));
  second = _mm256_cvtepi32_pd(_mm_srli_epi32(pairs, 16));
}
OKTETT_INLINE void gather_pairs(const float* base, batch<double, Avx> index, batch<double, Avx>& first,
                                batch<double, Avx>& second) {
  const __m256 pairs = _mm256_castpd_ps(
      _mm256_i32gather_pd(reinterpret_cast<const double*>(base), _mm256_cvttpd_epi32(index), sizeof(float)));
  const __m128 low = _mm256_castps256_ps128(pairs), high = _mm256_extractf128_ps(pairs, 1);
  first = _mm256_cvtps_pd(_mm_shuffle_ps(low, high, _MM_SHUFFLE(2, 0, 2, 0)));
  second = _mm256_cvtps_pd(_mm_shuffle_ps(low, high, _MM_SHUFFLE(3, 1, 3, 1)));
}
#endif
#if defined(OKTETT_COMPILED_AVX512)
OKTETT_INLINE void gather_pairs(const std::uint16_t* base, batch<double, Avx5> index,
                                batch<double, Avx5>& first, batch<double, Avx5>& second) {
  const __m256i pairs =
      _mm256_i32gather_epi32(reinterpret_cast<const int*>(base), _mm512_cvttpd_epi32(index), 2);
  first = _mm512_cvtepi32_pd(_mm256_and_si256(pairs, _mm256_set1_epi32(0xffff)));
  second = _mm512_cvtepi32_pd(_mm256_srli_epi32(pairs, 16));
}
OKTETT_INLINE void gather_pairs(const float* base, batch<double, Avx5> index, batch<double, Avx5>& first,
                                batch<double, Avx5>& second) {
  const __m512i pairs = _mm512_i32gather_epi64(_mm512_cvttpd_epi32(index), base, sizeof(float));
  first = _mm512_cvtps_pd(_mm256_castsi256_ps(_mm512_cvtepi64_epi32(pairs)));
  second = _mm512_cvtps_pd(_mm256_castsi256_ps(_mm512_cvtepi64_epi32(_mm512_srli_epi64(pairs, 32))));
}
#endif

}  // namespace native

/// base[index[i]] and base[index[i] + 1] in lane i, for floats and 16-bit numbers. The indices are whole
/// numbers from 0 to 2^31 - 1.
template <class T, int W, class A>
OKTETT_INLINE void gather_pairs(const T* base, const Simd<double, W, A>& index, Simd<double, W, A>& first,
                                Simd<double, W, A>& second) {
  for (int i = 0; i < first.kParts; ++i)
    native::gather_pairs(base, index.part[i], first.part[i], second.part[i]);
}

}  // namespace oktett
