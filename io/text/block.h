#pragma once
/// \file Thirty-two characters compared at once, the step in which scanners look for the end of a line.

#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
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
