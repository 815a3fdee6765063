#pragma once
/// \file Loads of lanes from several places in memory, four floats from each.

#include <type_traits>

#include "core/simd.h"

namespace oktett {

/// Lanes 4 k to 4 k + 3 are those at piece(k), which returns a pointer to floats.
template <int W, class A, class Piece>
OKTETT_INLINE Simd<float, W, A> load_pieces(const Piece& piece) {
#if defined(OKTETT_COMPILED_AVX512)
  if constexpr (std::is_same_v<A, Avx512Isa> && W == 16) {
    __m512 lanes = _mm512_castps128_ps512(_mm_loadu_ps(piece(0)));
    lanes = _mm512_insertf32x4(lanes, _mm_loadu_ps(piece(1)), 1);
    lanes = _mm512_insertf32x4(lanes, _mm_loadu_ps(piece(2)), 2);
    Simd<float, W, A> r;
    r.part[0] = _mm512_insertf32x4(lanes, _mm_loadu_ps(piece(3)), 3);
    return r;
  }
#endif
#if defined(OKTETT_COMPILED_AVX2)
  if constexpr (std::is_same_v<A, Avx2Isa> && W % 8 == 0) {
    Simd<float, W, A> r;
    for (int k = 0; k < r.kParts; ++k)
      r.part[k] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(piece(2 * k))),
                                       _mm_loadu_ps(piece(2 * k + 1)), 1);
    return r;
  }
#endif
  if constexpr (Simd<float, W, A>::kLanesPerPart == 4) {
    Simd<float, W, A> r;
    for (int k = 0; k < r.kParts; ++k) native::load(r.part[k], piece(k));
    return r;
  }
  alignas(64) float lanes[W];
  for (int k = 0; k < W / 4; ++k) Simd<float, 4, A>::load(piece(k)).store(lanes + 4 * k);
  return Simd<float, W, A>::load(lanes);
}

}  // namespace oktett
