#pragma once
/// \file Lanes from other places than consecutive memory: gathers, pieces, words of 16 bits, look-ups in rows
/// of sixteen, and entries of columns that an index names.

#include <cstdint>
#include <type_traits>

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

/// Entries index[0], index[1], ... of columns of floats, one for each lane of F. If they are consecutive,
/// they are loaded and stored at once.
template <class F>
class PickedLanes {
 public:
  explicit OKTETT_INLINE PickedLanes(const std::uint32_t* index) : index_(index) {
    for (int k = 1; k < F::kWidth; ++k) neighbours_ &= index[k] == index[0] + static_cast<std::uint32_t>(k);
  }
  OKTETT_INLINE F load(const float* column) const {
    if (neighbours_) return F::load(column + index_[0]);
    float lanes[F::kWidth];
    for (int k = 0; k < F::kWidth; ++k) lanes[k] = column[index_[k]];
    return F::load(lanes);
  }
  /// Lanes of the same entry must hold the same number.
  OKTETT_INLINE void store(const F& x, float* column) const {
    if (neighbours_) return x.store(column + index_[0]);
    float lanes[F::kWidth];
    x.store(lanes);
    for (int k = 0; k < F::kWidth; ++k) column[index_[k]] = lanes[k];
  }
  /// Adds to the entries of the lanes in `where`, one after the other if they are the same. All lanes must
  /// have an entry.
  OKTETT_INLINE void add(const F& x, float* column, unsigned where) const {
    if (neighbours_) {
      const F old = F::load(column + index_[0]);
      return select(F::M::from_bits(where), old + x, old).store(column + index_[0]);
    }
    float lanes[F::kWidth];
    x.store(lanes);
    for (; where != 0; where &= where - 1) {
      const int k = __builtin_ctz(where);
      column[index_[k]] += lanes[k];
    }
  }

 private:
  const std::uint32_t* index_;
  bool neighbours_ = true;
};

}  // namespace oktett
