#include "io/yaml/utf8.h"

#include <algorithm>
#include <cstdio>

#include "core/error.h"
#include "io/text/scan.h"

namespace oktett {
namespace {

bool is_inside_character(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

bool is_control(unsigned char c) { return (c < 0x20 && c != '\t' && c != '\n' && c != '\r') || c == 0x7f; }

}  // namespace

std::size_t character_length(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) {
    return static_cast<unsigned char>(i + k < text.size() ? text[i + k] : 0);
  };
  const auto follows = [&](std::size_t k, int lo, int hi) { return byte(k) >= lo && byte(k) <= hi; };
  const unsigned char b = byte(0);
  if (b < 0x80) return 1;
  if (b >= 0xc2 && b <= 0xdf) return follows(1, 0x80, 0xbf) ? 2 : 0;
  if (b >= 0xe0 && b <= 0xef) {
    const bool second = follows(1, b == 0xe0 ? 0xa0 : 0x80, b == 0xed ? 0x9f : 0xbf);
    return second && follows(2, 0x80, 0xbf) ? 3 : 0;
  }
  if (b >= 0xf0 && b <= 0xf4) {
    const bool second = follows(1, b == 0xf0 ? 0x90 : 0x80, b == 0xf4 ? 0x8f : 0xbf);
    return second && follows(2, 0x80, 0xbf) && follows(3, 0x80, 0xbf) ? 4 : 0;
  }
  return 0;
}

void check_text(std::string& text, const std::string& path) {
  text.erase(0, text.size() - without_byte_order_mark(text).size());
  Location place{path, 1, 1};
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    const std::size_t length = character_length(text, i);
    if (length == 0 || is_control(c)) {
      char hex[8];
      std::snprintf(hex, sizeof hex, "0x%02x", c);
      throw Error(place, std::string(length == 0 ? "not UTF-8 text: byte " : "not a text file: byte ") + hex);
    }
    i += length;
    if (c == '\n')
      ++place.line, place.column = 1;
    else
      ++place.column;
  }
}

std::size_t character_count(std::string_view text) {
  return text.size() - static_cast<std::size_t>(std::count_if(text.begin(), text.end(), is_inside_character));
}

std::string quote(std::string_view text, std::size_t max_characters) {
  std::string shown;
  std::size_t characters = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!is_inside_character(text[i]) && ++characters > max_characters) return "'" + shown + "...'";
    const auto c = static_cast<unsigned char>(text[i]);
    shown += c < 0x20 || c == 0x7f ? '?' : text[i];
  }
  return "'" + shown + "'";
}

ColumnCounter::ColumnCounter(const std::string& text)
    : text_(text), ascii_(std::none_of(text.begin(), text.end(), is_inside_character)) {}

std::uint32_t ColumnCounter::of(std::size_t offset, std::size_t byte_column) {
  if (ascii_) return static_cast<std::uint32_t>(byte_column + 1);
  offset = std::min(offset, text_.size());
  const std::size_t line_start = offset - std::min(byte_column, offset);
  if (line_start != line_start_) line_start_ = offset_ = line_start, characters_ = 0;
  const std::string_view text = text_;
  if (offset >= offset_)
    characters_ += character_count(text.substr(offset_, offset - offset_));
  else
    characters_ -= character_count(text.substr(offset, offset_ - offset));
  offset_ = offset;
  return static_cast<std::uint32_t>(characters_ + 1);
}

}  // namespace oktett
