#pragma once
/// \file Thirty-two characters compared at once, the step in which scanners look for the end of a line.

#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__ARM_NEON)
#include <arm_neon.h>
#endif

namespace oktett {

/// Thirty-two characters: few lines are longer, so that how many steps a line takes is mostly known
/// beforehand. Bit i of a result speaks of character i.
class TextBlock {
 public:
  static constexpr int size = 32;

#if defined(__SSE2__)
  explicit TextBlock(const char* p) : low_(load(p)), high_(load(p + 16)) {}

  std::uint32_t equal(char c) const {
    const __m128i wanted = _mm_set1_epi8(c);
    return bits(_mm_cmpeq_epi8(low_, wanted), _mm_cmpeq_epi8(high_, wanted));
  }
  /// Characters up to `c`, as unsigned codes.
  std::uint32_t at_most(char c) const {
    const __m128i limit = _mm_set1_epi8(c);
    return bits(_mm_cmpeq_epi8(_mm_min_epu8(low_, limit), low_),
                _mm_cmpeq_epi8(_mm_min_epu8(high_, limit), high_));
  }

 private:
  static __m128i load(const char* p) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p)); }
  static std::uint32_t bits(__m128i low, __m128i high) {
    return static_cast<std::uint32_t>(_mm_movemask_epi8(low)) |
           static_cast<std::uint32_t>(_mm_movemask_epi8(high)) << 16;
  }

  __m128i low_, high_;
#elif defined(__ARM_NEON)
  explicit TextBlock(const char* p) : low_(load(p)), high_(load(p + 16)) {}

  std::uint32_t equal(char c) const {
    const uint8x16_t wanted = vdupq_n_u8(static_cast<unsigned char>(c));
    return bits(vceqq_u8(low_, wanted), vceqq_u8(high_, wanted));
  }
  /// Characters up to `c`, as unsigned codes.
  std::uint32_t at_most(char c) const {
    const uint8x16_t limit = vdupq_n_u8(static_cast<unsigned char>(c));
    return bits(vcleq_u8(low_, limit), vcleq_u8(high_, limit));
  }

 private:
  static uint8x16_t load(const char* p) { return vld1q_u8(reinterpret_cast<const unsigned char*>(p)); }
  /// Each group of eight characters is a byte of the result; sums of neighbours, three times, put its bits
  /// together.
  static std::uint32_t bits(uint8x16_t low, uint8x16_t high) {
    const uint8x16_t weights{1, 2, 4, 8, 16, 32, 64, 128, 1, 2, 4, 8, 16, 32, 64, 128};
    const uint8x16_t pairs = vpaddq_u8(vandq_u8(low, weights), vandq_u8(high, weights));
    const uint8x16_t fours = vpaddq_u8(pairs, pairs);
    return vgetq_lane_u32(vreinterpretq_u32_u8(vpaddq_u8(fours, fours)), 0);
  }

  uint8x16_t low_, high_;
#else
  explicit TextBlock(const char* p) { std::memcpy(chars_, p, sizeof chars_); }

  std::uint32_t equal(char c) const {
    std::uint32_t bits = 0;
    for (int i = 0; i < size; ++i) bits |= std::uint32_t{chars_[i] == static_cast<unsigned char>(c)} << i;
    return bits;
  }
  /// Characters up to `c`, as unsigned codes.
  std::uint32_t at_most(char c) const {
    std::uint32_t bits = 0;
    for (int i = 0; i < size; ++i) bits |= std::uint32_t{chars_[i] <= static_cast<unsigned char>(c)} << i;
    return bits;
  }

 private:
  unsigned char chars_[size];
#endif
};

}  // namespace oktett
