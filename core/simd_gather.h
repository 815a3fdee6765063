#pragma once
/// \file Lanes from anywhere in memory.

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

}  // namespace oktett
