#pragma once
/// \file Characters of a text thirty-two at a time; and the blanks, lines and words of a text that is
/// followed by zero bytes (MappedFile). Lines end at LF, CR LF or CR; a backslash right before the end of a
/// line joins it with the next one, except behind a `#`.

#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#if defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__ARM_NEON)
#include <arm_neon.h>
#endif

namespace oktett {

/// The text behind the mark that some programs put before UTF-8.
inline std::string_view without_byte_order_mark(std::string_view text) {
  return text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text;
}

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

inline bool is_blank(char c) { return c == ' ' || c == '\t'; }

/// Ends a line; so does the zero behind the text.
inline bool is_line_end(char c) { return c == '\n' || c == '\r' || c == '\0'; }

/// Past the end of line at `p`; `p` itself at the end of the text.
inline const char* skip_line_end(const char* p) {
  if (*p == '\0') return p;
  return p + (p[0] == '\r' && p[1] == '\n' ? 2 : 1);
}

/// The start of the line behind the one that ends at `line_end`; a zero byte within the text ends a line too.
inline const char* next_line(const char* line_end, const char* text_end) {
  if (*line_end != '\0') return skip_line_end(line_end);
  return line_end < text_end ? line_end + 1 : text_end;
}

/// A backslash at the end of the text joins nothing, and means nothing.
inline bool is_continuation(const char* p) { return p[0] == '\\' && is_line_end(p[1]); }

inline const char* skip_plain_blanks(const char* p) {
  while (is_blank(*p)) ++p;
  return p;
}

/// Past blanks and joints of lines.
inline const char* skip_blanks(const char* p) {
  for (;;) {
    if (is_blank(*p))
      ++p;
    else if (is_continuation(p))
      p = skip_line_end(p + 1);
    else
      return p;
  }
}

/// What may follow a number or a word: a blank, the end of the line, a comment, a joint of lines.
inline bool is_delimiter(const char* p) {
  return is_blank(*p) || is_line_end(*p) || *p == '#' || is_continuation(p);
}

/// What a line looks like, found without reading it character by character.
struct LineShape {
  const char* end;          ///< the LF, CR or zero byte that ends the physical line
  std::uint32_t words = 0;  ///< runs of characters above the blank
  bool slash = false;
  bool hash = false;
  bool backslash = false;

  /// Whether the physical line is all there is, without a comment.
  bool plain() const { return !hash && !backslash; }
  /// Whether a backslash ends it that is no part of a word.
  bool ends_in_joint() const { return backslash && !hash && end[-1] == '\\'; }
  /// Whether the next physical line belongs to this one.
  bool continued() const { return ends_in_joint() && *end != '\0'; }
};

/// Number of ones; the baseline has no instruction for it.
inline std::uint32_t count_bits(std::uint32_t bits) {
  bits = bits - ((bits >> 1) & 0x55555555u);
  bits = (bits & 0x33333333u) + ((bits >> 2) & 0x33333333u);
  return (((bits + (bits >> 4)) & 0x0f0f0f0fu) * 0x01010101u) >> 24;
}

/// The shape of the physical line from `p` on.
inline LineShape measure_line(const char* p) {
  std::uint32_t slash = 0, hash = 0, backslash = 0, words = 0;
  std::uint32_t before_is_blank = 1;
  for (;; p += TextBlock::size) {
    const TextBlock block(p);
    const std::uint32_t ends = block.equal('\n') | block.equal('\r') | block.equal('\0');
    // All bits if the line does not end in this block, else those before its end.
    const std::uint32_t inside = ends ? (ends & (~ends + 1)) - 1 : ~0u;
    const std::uint32_t blank = block.at_most(' ');
    words += count_bits(~blank & (blank << 1 | before_is_blank) & inside);
    before_is_blank = blank >> (TextBlock::size - 1);
    slash |= block.equal('/') & inside;
    hash |= block.equal('#') & inside;
    backslash |= block.equal('\\') & inside;
    if (ends) return {p + std::countr_zero(ends), words, slash != 0, hash != 0, backslash != 0};
  }
}

/// The LF, CR or zero byte that ends the physical line from `p` on.
inline const char* find_line_end(const char* p) {
  for (;; p += TextBlock::size) {
    const TextBlock block(p);
    const std::uint32_t ends = block.equal('\n') | block.equal('\r') | block.equal('\0');
    if (ends) return p + std::countr_zero(ends);
  }
}

/// The end of the line from `p` on, joined lines included; `p` must not lie behind a `#` of its line.
const char* find_joined_line_end(const char* p);

/// Where the next word of the joined line starts, or its end: a line end or a comment.
inline const char* next_word(const char* p) {
  p = skip_blanks(p);
  return *p == '#' ? find_line_end(p) : p;
}

/// The word at `p`, up to a delimiter.
std::string_view word_at(const char* p);

/// Number of words up to the end of the joined line, or to a comment.
std::size_t count_words(const char* p);

/// [begin, end) without blanks at its ends.
std::string_view trimmed(const char* begin, const char* end);

struct TextPosition {
  int line = 1;
  int column = 1;  ///< in bytes
};

/// Finds lines and columns, counted from 1, by counting line ends: for messages, not for every statement.
class LineCounter {
 public:
  explicit LineCounter(std::string_view text) : text_(text), line_(text.data()) {}

  /// The position of `p` in the text. Cheap if the places asked for come in the order of the text.
  TextPosition at(const char* p);

 private:
  std::string_view text_;
  const char* line_;
  std::size_t count_ = 1;
};

}  // namespace oktett
