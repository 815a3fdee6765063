#pragma once
/// \file Sixteen characters compared at once, the step in which scanners look for the end of a line.

#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace oktett {

/// Sixteen characters. Bit i of a result speaks of character i.
class TextBlock {
 public:
  static constexpr int size = 16;

#if defined(__SSE2__)
  explicit TextBlock(const char* p) : chars_(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p))) {}

  std::uint32_t equal(char c) const { return bits(_mm_cmpeq_epi8(chars_, _mm_set1_epi8(c))); }
  /// Characters up to `c`, as unsigned codes.
  std::uint32_t at_most(char c) const {
    return bits(_mm_cmpeq_epi8(_mm_min_epu8(chars_, _mm_set1_epi8(c)), chars_));
  }

 private:
  static std::uint32_t bits(__m128i mask) { return static_cast<std::uint32_t>(_mm_movemask_epi8(mask)); }

  __m128i chars_;
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
