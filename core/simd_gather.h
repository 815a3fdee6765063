#pragma once
/// \file Gathers: loads of lanes from arbitrary indices.

#include <cstdint>

#include "core/simd.h"

namespace oktett {

/// base[index[i]] in lane i.
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> gather(const float* base, const Simd<std::int32_t, W, A>& index) {
#if defined(OKTETT_COMPILED_AVX512)
  if constexpr (std::is_same_v<A, Avx512Isa> && W == 16) {
    Simd<float, W, A> r;
    r.part[0] = _mm512_i32gather_ps(index.part[0], base, sizeof(float));
    return r;
  }
#endif
  alignas(64) std::int32_t at[W];
  alignas(64) float lanes[W];
  index.store(at);
  for (int i = 0; i < W; ++i) lanes[i] = base[at[i]];
  return Simd<float, W, A>::load(lanes);
}

/// words[index[i]] in lane i. The word behind each of these is read too, and must exist.
template <int W, class A>
OKTETT_INLINE Simd<std::int32_t, W, A> gather(const std::uint16_t* words,
                                              const Simd<std::int32_t, W, A>& index) {
#if defined(OKTETT_COMPILED_AVX512)
  if constexpr (std::is_same_v<A, Avx512Isa> && W == 16) {
    Simd<std::int32_t, W, A> r;
    r.part[0] = _mm512_and_si512(_mm512_i32gather_epi32(index.part[0], words, sizeof(std::uint16_t)),
                                 _mm512_set1_epi32(0xffff));
    return r;
  }
#endif
  alignas(64) std::int32_t lanes[W];
  index.store(lanes);
  for (std::int32_t& lane : lanes) lane = words[lane];
  return Simd<std::int32_t, W, A>::load(lanes);
}

namespace native {

template <class B>
OKTETT_INLINE B gather(const float* base, const B& index) {
  double lanes[B::size];
  native::store(lanes, index);
  for (double& lane : lanes) lane = static_cast<double>(base[static_cast<std::int32_t>(lane)]);
  B r;
  native::load(r, lanes);
  return r;
}
#if defined(OKTETT_COMPILED_AVX2)
OKTETT_INLINE batch<double, Avx> gather(const float* base, batch<double, Avx> index) {
  return _mm256_cvtps_pd(_mm_i32gather_ps(base, _mm256_cvttpd_epi32(index), sizeof(float)));
}
#endif
#if defined(OKTETT_COMPILED_AVX512)
OKTETT_INLINE batch<double, Avx5> gather(const float* base, batch<double, Avx5> index) {
  return _mm512_cvtps_pd(_mm256_i32gather_ps(base, _mm512_cvttpd_epi32(index), sizeof(float)));
}
#endif

}  // namespace native

/// base[index[i]] in lane i. The indices are whole numbers from 0 to 2^31 - 1.
template <int W, class A>
OKTETT_INLINE Simd<double, W, A> gather(const float* base, const Simd<double, W, A>& index) {
  Simd<double, W, A> r;
  for (int i = 0; i < r.kParts; ++i) r.part[i] = native::gather(base, index.part[i]);
  return r;
}

}  // namespace oktett
