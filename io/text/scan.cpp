#include "io/text/scan.h"

#include <algorithm>
#include <limits>

namespace oktett {

const char* find_joined_line_end(const char* p) {
  for (;;) {
    const LineShape line = measure_line(p);
    if (!line.continued()) return line.end;
    p = skip_line_end(line.end);
  }
}

std::string_view word_at(const char* p) {
  const char* end = p;
  while (!is_delimiter(end)) ++end;
  return {p, static_cast<std::size_t>(end - p)};
}

std::size_t count_words(const char* p) {
  std::size_t count = 0;
  for (p = next_word(p); !is_line_end(*p); p = next_word(p)) {
    ++count;
    while (!is_delimiter(p)) ++p;
  }
  return count;
}

std::string_view trimmed(const char* begin, const char* end) {
  while (begin < end && is_blank(*begin)) ++begin;
  while (begin < end && is_blank(end[-1])) --end;
  return {begin, static_cast<std::size_t>(end - begin)};
}

TextPosition LineCounter::at(const char* p) {
  if (p < line_) *this = LineCounter(text_);
  const char* const text_end = text_.data() + text_.size();
  for (const char* end = find_line_end(line_); end < p; end = find_line_end(end)) {
    // A zero byte within the text is not taken for the end of a line here: editors do not either.
    if (*end == '\0') {
      ++end;
      continue;
    }
    const char* next = next_line(end, text_end);
    if (next > p) break;
    line_ = end = next;
    ++count_;
  }
  constexpr auto most = static_cast<std::size_t>(std::numeric_limits<int>::max());
  const auto column = static_cast<std::size_t>(p - line_) + 1;
  return {static_cast<int>(std::min(count_, most)), static_cast<int>(std::min(column, most))};
}

}  // namespace oktett
