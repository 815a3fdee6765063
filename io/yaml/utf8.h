#pragma once
/// \file Characters of UTF-8 text: validation, counting, shortening.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace oktett {

/// Removes a byte order mark from `text`. Throws Error with line and column, in characters, at the first byte
/// that is not UTF-8 or is a control character other than tab, line feed and carriage return.
void check_text(std::string& text, const std::string& path);

/// Length of the well-formed character at `text[i]` (Unicode 15, table 3-7); 0 if it is malformed.
std::size_t character_length(std::string_view text, std::size_t i);

/// Number of characters (code points) in valid UTF-8; a truncated last character counts as one.
std::size_t character_count(std::string_view text);

/// `text` in single quotes for a message: control characters as '?', cut after `max_characters`.
std::string quote(std::string_view text, std::size_t max_characters = 40);

/// Turns byte columns into character columns. Cheap if asked in the order of the text.
class ColumnCounter {
 public:
  /// `text` must outlive the counter.
  explicit ColumnCounter(const std::string& text);

  /// Column from 1 in characters of the byte at `offset`, which stands `byte_column` bytes behind its line's
  /// start.
  std::uint32_t of(std::size_t offset, std::size_t byte_column);

 private:
  const std::string& text_;
  bool ascii_;
  std::size_t line_start_ = 0, offset_ = 0, characters_ = 0;
};

}  // namespace oktett
