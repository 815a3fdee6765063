#pragma once
/// \file Lookups in rows of sixteen floats, by indices of four bits that are packed in 16-bit words.

#include <cstdint>

#include "core/simd.h"

namespace oktett {

/// W words of 16 bits, each of which holds indices from 0 to 15: index k stands in the bits from 4 k on.
template <int W, class A>
class PackedIndices {
 public:
  OKTETT_INLINE explicit PackedIndices(const std::uint16_t* words) : words_(words) {}

  /// row[index k of word i] in lane i, k < 3.
  OKTETT_INLINE Simd<float, W, A> look_up(int k, const float* row) const {
    float lanes[W];
    for (int i = 0; i < W; ++i) lanes[i] = row[words_[i] >> 4 * k & 15];
    return Simd<float, W, A>::load(lanes);
  }

 private:
  const std::uint16_t* words_;
};

#if defined(OKTETT_COMPILED_AVX2)
template <class A>
requires kHasFma<A>
class PackedIndices<8, A> {
 public:
  OKTETT_INLINE explicit PackedIndices(const std::uint16_t* words)
      : words_(_mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(words)))) {}

  OKTETT_INLINE Simd<float, 8, A> look_up(int k, const float* row) const {
    const __m256 low = _mm256_loadu_ps(row), high = _mm256_loadu_ps(row + 8);
    const __m256i index = _mm256_srli_epi32(words_, 4 * k);
    Simd<float, 8, A> r;
#if defined(OKTETT_COMPILED_AVX512)
    if constexpr (std::is_same_v<A, Avx512Isa>) {
      // Looks at the four lowest bits of an index.
      r.part[0] = _mm256_permutex2var_ps(low, index, high);
      return r;
    }
#endif
    // Permutations look at the three lowest bits of an index, blends at the highest.
    r.part[0] = _mm256_blendv_ps(_mm256_permutevar8x32_ps(low, index), _mm256_permutevar8x32_ps(high, index),
                                 _mm256_castsi256_ps(_mm256_slli_epi32(words_, 28 - 4 * k)));
    return r;
  }

 private:
  __m256i words_;
};
#endif

#if defined(OKTETT_COMPILED_NEON)
template <>
class PackedIndices<8, NeonIsa> {
 public:
  OKTETT_INLINE explicit PackedIndices(const std::uint16_t* words) : words_(vld1q_u16(words)) {}

  OKTETT_INLINE Simd<float, 8, NeonIsa> look_up(int k, const float* row) const {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(row);
    const uint8x16x4_t table{
        {vld1q_u8(bytes), vld1q_u8(bytes + 16), vld1q_u8(bytes + 32), vld1q_u8(bytes + 48)}};
    const uint16x8_t index =
        vandq_u16(vshlq_u16(words_, vdupq_n_s16(static_cast<short>(-4 * k))), vdupq_n_u16(15));
    const auto floats = [&](uint32x4_t lanes) {
      return vreinterpretq_f32_u8(vqtbl4q_u8(table, native::byte_places(lanes)));
    };
    Simd<float, 8, NeonIsa> r;
    r.part[0] = floats(vmovl_u16(vget_low_u16(index)));
    r.part[1] = floats(vmovl_high_u16(index));
    return r;
  }

 private:
  uint16x8_t words_;
};
#endif

/// Two times eight words, each eight with rows of their own.
template <class A>
class PackedIndexPair {
 public:
  OKTETT_INLINE PackedIndexPair(const std::uint16_t* first, const std::uint16_t* second)
      : first_(first), second_(second) {}

  /// The lanes that the eight words of `first` find in the row `first`, then those of `second`.
  OKTETT_INLINE Simd<float, 16, A> look_up(int k, const float* first, const float* second) const {
    return concat(first_.look_up(k, first), second_.look_up(k, second));
  }

 private:
  PackedIndices<8, A> first_, second_;
};

#if defined(OKTETT_COMPILED_AVX512)
template <>
class PackedIndexPair<Avx512Isa> {
 public:
  OKTETT_INLINE PackedIndexPair(const std::uint16_t* first, const std::uint16_t* second)
      : words_(_mm512_cvtepu16_epi32(
            _mm256_set_m128i(_mm_loadu_si128(reinterpret_cast<const __m128i*>(second)),
                             _mm_loadu_si128(reinterpret_cast<const __m128i*>(first))))) {}

  OKTETT_INLINE Simd<float, 16, Avx512Isa> look_up(int k, const float* first, const float* second) const {
    // Bit 4 of an index chooses the row.
    const __m512i rows = _mm512_inserti64x4(_mm512_setzero_si512(), _mm256_set1_epi32(16), 1);
    const __m512i index = _mm512_or_si512(
        _mm512_and_si512(_mm512_srli_epi32(words_, static_cast<unsigned>(4 * k)), _mm512_set1_epi32(15)),
        rows);
    Simd<float, 16, Avx512Isa> r;
    r.part[0] = _mm512_permutex2var_ps(_mm512_loadu_ps(first), index, _mm512_loadu_ps(second));
    return r;
  }

 private:
  __m512i words_;
};
#endif

}  // namespace oktett
