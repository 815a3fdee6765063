#pragma once
/// \file Sorting and compacting lanes: how a traversal pushes the children of a node in order, and how
/// rays that leave some of the lanes are written.

#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/simd.h"
#include "core/vec3.h"

namespace oktett {

namespace native {

#if defined(OKTETT_COMPILED_AVX2) || defined(OKTETT_COMPILED_NEON)
/// Entry m lists the lanes that are set in m, lowest first, one byte each.
struct CompactTable {
  std::uint64_t lanes[256] = {};
  constexpr CompactTable() {
    for (unsigned m = 0; m < 256; ++m)
      for (unsigned lane = 0, to = 0; lane < 8; ++lane)
        if (m >> lane & 1) lanes[m] |= std::uint64_t{lane} << (8 * to++);
  }
};
// Not inline: each instruction set has its own copy, so that no code is shared between sets.
constexpr CompactTable kCompact;
#endif

#if defined(OKTETT_COMPILED_AVX2)
/// The index vector that brings the lanes of `m` to the front.
OKTETT_INLINE __m256i compact_index(unsigned m) {
  return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(kCompact.lanes[m])));
}

/// One layer of a sorting network: lanes meet their partners, the greater goes to the lower lane.
template <int kUpperLanes>
OKTETT_INLINE __m256i exchange(__m256i a, __m256i partner) {
  return _mm256_blend_epi32(_mm256_max_epi32(a, partner), _mm256_min_epi32(a, partner), kUpperLanes);
}

template <int kUpperLanes>
OKTETT_INLINE __m128i exchange(__m128i a, __m128i partner) {
  return _mm_blend_epi32(_mm_max_epi32(a, partner), _mm_min_epi32(a, partner), kUpperLanes);
}

/// The first three layers of the sort below: greatest of four lanes first.
OKTETT_INLINE __m128i sort_descending(__m128i a) {
  a = exchange<0xa>(a, _mm_shuffle_epi32(a, 0xb1));
  a = exchange<0xc>(a, _mm_shuffle_epi32(a, 0x1b));
  return exchange<0xa>(a, _mm_shuffle_epi32(a, 0xb1));
}

/// Batcher's bitonic sort (1968) with all exchanges in one direction: greatest lane first.
OKTETT_INLINE __m256i sort_descending(__m256i a) {
  const auto neighbours = [](__m256i v) { return _mm256_shuffle_epi32(v, 0xb1); };
  const __m256i reverse = _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0);
  a = exchange<0xaa>(a, neighbours(a));
  a = exchange<0xcc>(a, _mm256_shuffle_epi32(a, 0x1b));
  a = exchange<0xaa>(a, neighbours(a));
  a = exchange<0xf0>(a, _mm256_permutevar8x32_epi32(a, reverse));
  a = exchange<0xcc>(a, _mm256_shuffle_epi32(a, 0x4e));
  return exchange<0xaa>(a, neighbours(a));
}

/// The first `count` of four lanes, all bits set.
OKTETT_INLINE __m128i first_lanes(int count) {
  return _mm_cmpgt_epi32(_mm_set1_epi32(count), _mm_setr_epi32(0, 1, 2, 3));
}

/// The lanes in `m`, at most four, moved to the front and followed by zeros.
template <class A>
OKTETT_INLINE __m128i front(__m256i a, unsigned m) {
#if defined(OKTETT_COMPILED_AVX512)
  if constexpr (std::is_same_v<A, Avx512Isa>)
    return _mm256_castsi256_si128(_mm256_maskz_compress_epi32(static_cast<__mmask8>(m), a));
#endif
  const __m256i moved = _mm256_permutevar8x32_epi32(a, compact_index(m));
  return _mm_and_si128(_mm256_castsi256_si128(moved), first_lanes(__builtin_popcount(m)));
}
#elif defined(OKTETT_COMPILED_NEON)
/// Eight lanes of 32 bits.
using NeonEight = uint8x16x2_t;

OKTETT_INLINE NeonEight load_eight(const void* p) {
  const auto* bytes = static_cast<const std::uint8_t*>(p);
  return {{vld1q_u8(bytes), vld1q_u8(bytes + 16)}};
}
OKTETT_INLINE void store_eight(void* p, const NeonEight& a) {
  auto* bytes = static_cast<std::uint8_t*>(p);
  vst1q_u8(bytes, a.val[0]);
  vst1q_u8(bytes + 16, a.val[1]);
}

/// The lanes of `m` at the front.
OKTETT_INLINE NeonEight compact(const NeonEight& a, unsigned m) {
  const uint16x8_t index = vmovl_u8(vcreate_u8(kCompact.lanes[m]));
  return {{vqtbl2q_u8(a, byte_places(vmovl_u16(vget_low_u16(index)))),
           vqtbl2q_u8(a, byte_places(vmovl_high_u16(index)))}};
}

/// One layer of a sorting network: lanes meet their partners, the greater goes to the lanes that are not in
/// `upper`.
OKTETT_INLINE int32x4_t exchange(uint32x4_t upper, int32x4_t a, int32x4_t partner) {
  return vbslq_s32(upper, vminq_s32(a, partner), vmaxq_s32(a, partner));
}
OKTETT_INLINE int32x4_t swap_neighbours(int32x4_t a) { return vrev64q_s32(a); }
OKTETT_INLINE int32x4_t swap_pairs(int32x4_t a) { return vextq_s32(a, a, 2); }
OKTETT_INLINE int32x4_t reverse(int32x4_t a) { return swap_pairs(swap_neighbours(a)); }

/// The layers of the sort below that stay within four lanes: greatest lane first.
OKTETT_INLINE int32x4_t sort_descending(int32x4_t a) {
  constexpr std::uint32_t kAll = ~0u;
  const uint32x4_t odd{0, kAll, 0, kAll}, second_half{0, 0, kAll, kAll};
  a = exchange(odd, a, swap_neighbours(a));
  a = exchange(second_half, a, reverse(a));
  return exchange(odd, a, swap_neighbours(a));
}

/// Batcher's bitonic sort (1968) with all exchanges in one direction: greatest of eight lanes first.
OKTETT_INLINE void sort_descending(int32x4_t& lo, int32x4_t& hi) {
  constexpr std::uint32_t kAll = ~0u;
  const uint32x4_t odd{0, kAll, 0, kAll}, second_half{0, 0, kAll, kAll};
  lo = sort_descending(lo);
  hi = reverse(sort_descending(hi));
  const int32x4_t greater = vmaxq_s32(lo, hi), lesser = vminq_s32(lo, hi);
  const auto merge = [&](int32x4_t a) {
    a = exchange(second_half, a, swap_pairs(a));
    return exchange(odd, a, swap_neighbours(a));
  };
  lo = merge(greater);
  hi = merge(lesser);
}
#endif

}  // namespace native

/// Lanes with a <= b, as bits.
template <class A>
OKTETT_INLINE unsigned less_equal_lanes(const Simd<float, 8, A>& a, const Simd<float, 8, A>& b) {
#if defined(OKTETT_COMPILED_AVX512)
  if constexpr (std::is_same_v<A, Avx512Isa>) return _mm256_cmp_ps_mask(a.part[0], b.part[0], _CMP_LE_OQ);
#endif
  return bits(a <= b);
}

/// Writes the `values` of the lanes in `lanes` to `out_values`, greatest key first, and the keys to
/// `out_keys`; returns their number. Keys are at least 0 and come back up to eight units in the last place
/// smaller. All eight elements of the outputs may be overwritten.
template <class A>
OKTETT_INLINE int store_descending(const Simd<float, 8, A>& keys, unsigned lanes, const std::uint32_t* values,
                                   std::uint32_t* out_values, float* out_keys) {
#if defined(OKTETT_COMPILED_AVX2)
  if constexpr (kHasFma<A>) {
    // The last bits of a key are replaced by its lane number, so the sorted keys contain the permutation.
    const __m256i low = _mm256_set1_epi32(7);
    const __m256i key = _mm256_or_si256(_mm256_andnot_si256(low, _mm256_castps_si256(keys.part[0])),
                                        _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
    const __m256i v = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(values));
    const int count = __builtin_popcount(lanes);
    if (OKTETT_LIKELY(count <= 4)) {
      // Four keys, moved to the front, need half a network. The entries behind them are 0 or lane numbers.
      const __m128i sorted = native::sort_descending(native::front<A>(key, lanes));
      const __m256i order = _mm256_castsi128_si256(sorted);
      _mm_storeu_si128(reinterpret_cast<__m128i*>(out_values),
                       _mm256_castsi256_si128(_mm256_permutevar8x32_epi32(v, order)));
      _mm_storeu_ps(out_keys, _mm_castsi128_ps(_mm_andnot_si128(_mm256_castsi256_si128(low), sorted)));
      return count;
    }
    const Mask<std::int32_t, 8, A> met = Mask<std::int32_t, 8, A>::from_bits(lanes);
    const __m256i idle = _mm256_andnot_si256(met.part[0], _mm256_set1_epi32(INT32_MIN));
    const __m256i sorted = native::sort_descending(_mm256_or_si256(key, idle));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out_values), _mm256_permutevar8x32_epi32(v, sorted));
    _mm256_storeu_ps(out_keys, _mm256_castsi256_ps(_mm256_andnot_si256(low, sorted)));
    return count;
  }
#elif defined(OKTETT_COMPILED_NEON)
  if constexpr (std::is_same_v<A, NeonIsa>) {
    // As with AVX2: the sorted keys contain the permutation.
    const int32x4_t low = vdupq_n_s32(7);
    const auto numbered = [&](int k, int32x4_t numbers) {
      return vorrq_s32(vbicq_s32(vreinterpretq_s32_f32(keys.part[k]), low), numbers);
    };
    const auto key_of = [&](int32x4_t sorted) { return vreinterpretq_f32_s32(vbicq_s32(sorted, low)); };
    const auto places = [&](int32x4_t sorted) {
      return native::byte_places(vreinterpretq_u32_s32(vandq_s32(sorted, low)));
    };
    const native::NeonEight v = native::load_eight(values);
    int32x4_t first = numbered(0, int32x4_t{0, 1, 2, 3}), second = numbered(1, int32x4_t{4, 5, 6, 7});
    const int count = __builtin_popcount(lanes);
    auto* const out_bytes = reinterpret_cast<std::uint8_t*>(out_values);
    if (OKTETT_LIKELY(count <= 4)) {
      const native::NeonEight given{{vreinterpretq_u8_s32(first), vreinterpretq_u8_s32(second)}};
      const uint32x4_t present = vcgtq_s32(vdupq_n_s32(count), int32x4_t{0, 1, 2, 3});
      const int32x4_t front = vreinterpretq_s32_u8(native::compact(given, lanes).val[0]);
      const int32x4_t sorted = native::sort_descending(vandq_s32(front, vreinterpretq_s32_u32(present)));
      vst1q_u8(out_bytes, vqtbl2q_u8(v, places(sorted)));
      vst1q_f32(out_keys, key_of(sorted));
      return count;
    }
    const auto met = Mask<std::int32_t, 8, A>::from_bits(lanes);
    const uint32x4_t idle = vdupq_n_u32(0x80000000u);
    const auto with_idle = [&](int32x4_t a, int k) {
      return vorrq_s32(a, vreinterpretq_s32_u32(vbicq_u32(idle, met.part[k])));
    };
    first = with_idle(first, 0);
    second = with_idle(second, 1);
    native::sort_descending(first, second);
    vst1q_u8(out_bytes, vqtbl2q_u8(v, places(first)));
    vst1q_u8(out_bytes + 16, vqtbl2q_u8(v, places(second)));
    vst1q_f32(out_keys, key_of(first));
    vst1q_f32(out_keys + 4, key_of(second));
    return count;
  }
#endif
  alignas(64) float key[8];
  keys.store(key);
  int size = 0;
  for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
    const int k = __builtin_ctz(rest);
    int at = size++;
    while (at > 0 && out_keys[at - 1] < key[k])
      out_keys[at] = out_keys[at - 1], out_values[at] = out_values[at - 1], --at;
    out_keys[at] = key[k], out_values[at] = values[k];
  }
  return size;
}

/// Eight lanes that are taken one by one, the one with the least key first. Keys are at least 0.
template <class A>
class LaneOrder {
 public:
  /// The lane with the least key that has not been taken.
  class Least {
   public:
    /// The bits of its key, with the lane's number in the last three; greater than those of any float if all
    /// lanes have been taken.
    OKTETT_INLINE std::uint32_t key() const { return key_; }
    OKTETT_INLINE unsigned lane() const { return key_ & 7; }
    /// The one of eight `values` that belongs to it.
    OKTETT_INLINE std::uint32_t pick(const std::uint32_t* values) const { return values[lane()]; }

   private:
    friend class LaneOrder;
    std::uint32_t key_ = ~0u;
  };

  LaneOrder() = default;
  /// The lanes in `given`.
  OKTETT_INLINE LaneOrder(const Simd<float, 8, A>& keys, const Mask<float, 8, A>& given) {
    float key[8];
    keys.store(key);
    const unsigned lanes = bits(given);
    for (unsigned k = 0; k < 8; ++k)
      key_[k] = (lanes >> k & 1) != 0 ? (std::bit_cast<std::uint32_t>(key[k]) & ~7u) | k : ~0u;
  }

  OKTETT_INLINE Least least() const {
    Least l;
    for (const std::uint32_t key : key_) l.key_ = key < l.key_ ? key : l.key_;
    return l;
  }
  OKTETT_INLINE void take(const Least& l) {
    for (std::uint32_t& key : key_) key |= key == l.key_ ? ~0u : 0u;
  }

 private:
  std::uint32_t key_[8];
};

#if defined(OKTETT_COMPILED_AVX2)
template <class A>
requires kHasFma<A>
class LaneOrder<A> {
 public:
  class Least {
   public:
    OKTETT_INLINE std::uint32_t key() const { return static_cast<std::uint32_t>(_mm256_cvtsi256_si32(key_)); }
    OKTETT_INLINE unsigned lane() const { return key() & 7; }
    /// In registers: a ray waits for this, and a look-up in memory takes longer.
    OKTETT_INLINE std::uint32_t pick(const std::uint32_t* values) const {
      const __m256i v = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(values));
      return static_cast<std::uint32_t>(_mm256_cvtsi256_si32(_mm256_permutevar8x32_epi32(v, key_)));
    }

   private:
    friend class LaneOrder;
    __m256i key_;  ///< in all lanes
  };

  LaneOrder() = default;
  OKTETT_INLINE LaneOrder(const Simd<float, 8, A>& keys, const Mask<float, 8, A>& given) {
    const __m256i key =
        _mm256_or_si256(_mm256_andnot_si256(_mm256_set1_epi32(7), _mm256_castps_si256(keys.part[0])),
                        _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
    const __m256i left_out = _mm256_andnot_si256(_mm256_castps_si256(given.part[0]), _mm256_set1_epi32(-1));
    key_ = _mm256_or_si256(key, left_out);
  }

  OKTETT_INLINE Least least() const {
    Least l;
    l.key_ = _mm256_min_epu32(key_, _mm256_permute2x128_si256(key_, key_, 1));
    l.key_ = _mm256_min_epu32(l.key_, _mm256_shuffle_epi32(l.key_, 0x4e));
    l.key_ = _mm256_min_epu32(l.key_, _mm256_shuffle_epi32(l.key_, 0xb1));
    return l;
  }
  OKTETT_INLINE void take(const Least& l) { key_ = _mm256_or_si256(key_, _mm256_cmpeq_epi32(key_, l.key_)); }

 private:
  __m256i key_;
};
#endif

/// Writes the `values` of the lanes in `lanes` to `out`, lowest lane first; returns their number. T has 32
/// bits. Eight `values` are read, and eight of `out` may be overwritten; it may begin at `values` or before.
template <class A, class T>
OKTETT_INLINE int store_compact(unsigned lanes, const T* values, T* out) {
#if defined(OKTETT_COMPILED_AVX2)
  if constexpr (kHasFma<A>) {
    const __m256i v = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(values));
    __m256i front;
#if defined(OKTETT_COMPILED_AVX512)
    if constexpr (std::is_same_v<A, Avx512Isa>)
      front = _mm256_maskz_compress_epi32(static_cast<__mmask8>(lanes), v);
    else
#endif
      front = _mm256_permutevar8x32_epi32(v, native::compact_index(lanes));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), front);
    return __builtin_popcount(lanes);
  }
#elif defined(OKTETT_COMPILED_NEON)
  if constexpr (std::is_same_v<A, NeonIsa>) {
    native::store_eight(out, native::compact(native::load_eight(values), lanes));
    return __builtin_popcount(lanes);
  }
#endif
  int size = 0;
  for (; lanes != 0; lanes &= lanes - 1) out[size++] = values[__builtin_ctz(lanes)];
  return size;
}

/// The same with the lanes of a register. W elements of `out` may be overwritten, and no fewer than eight.
template <int W, class A>
OKTETT_INLINE int store_compact(unsigned lanes, const Simd<float, W, A>& values, float* out) {
#if defined(OKTETT_COMPILED_AVX512)
  if constexpr (std::is_same_v<A, Avx512Isa> && W == 16) {
    _mm512_storeu_ps(out, _mm512_maskz_compress_ps(static_cast<__mmask16>(lanes), values.part[0]));
    return __builtin_popcount(lanes);
  }
#endif
  constexpr int kGroup = W < 8 ? W : 8;
  float stored[W < 8 ? 8 : W];
  values.store(stored);
  int size = 0;
  for (int k = 0; k < W; k += kGroup)
    size += store_compact<A>(lanes >> k & ((1u << kGroup) - 1), stored + k, out + size);
  return size;
}
/// Vectors in three columns, from element `at` on.
template <int W, class A>
OKTETT_INLINE int store_compact(unsigned lanes, const Vec3<Simd<float, W, A>>& values, float* const (&out)[3],
                                std::size_t at) {
  store_compact(lanes, values.x, out[0] + at), store_compact(lanes, values.y, out[1] + at);
  return store_compact(lanes, values.z, out[2] + at);
}

/// Writes base + i for each of the 16 bits i that are set, lowest first; returns their number. Sixteen
/// elements of `out` may be overwritten.
template <class A>
OKTETT_INLINE int store_set_bits(unsigned set, std::int32_t base, std::int32_t* out) {
#if defined(OKTETT_COMPILED_AVX512)
  if constexpr (std::is_same_v<A, Avx512Isa>) {
    const __m512i lane = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    _mm512_storeu_si512(out, _mm512_maskz_compress_epi32(static_cast<__mmask16>(set),
                                                         _mm512_add_epi32(lane, _mm512_set1_epi32(base))));
    return __builtin_popcount(set);
  }
#endif
  int size = 0;
  for (; set != 0; set &= set - 1) out[size++] = base + __builtin_ctz(set);
  return size;
}

}  // namespace oktett
