#include "tests/support/terminal_pictures.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <sstream>

namespace oktett::test {
namespace {

/// The text between `begin` and `end` at or behind `at`, which then is behind `end`.
std::optional<std::string> next_between(const std::string& text, const char* begin, const char* end,
                                        std::size_t& at) {
  const std::size_t first = text.find(begin, at);
  if (first == std::string::npos) return std::nullopt;
  const std::size_t start = first + std::strlen(begin), last = text.find(end, start);
  if (last == std::string::npos) return std::nullopt;
  at = last + std::strlen(end);
  return text.substr(start, last - start);
}

/// The whole numbers of a text in which other characters stand between them.
std::vector<int> numbers_of(const std::string& text) {
  std::vector<int> numbers;
  bool inside = false;
  for (const char c : text) {
    const bool digit = c >= '0' && c <= '9';
    if (digit && !inside) numbers.push_back(0);
    if (digit) numbers.back() = 10 * numbers.back() + (c - '0');
    inside = digit;
  }
  return numbers;
}

using Rgba = std::array<std::uint8_t, 4>;

/// Colour `index` of the 256 that terminals have, from 16 on.
Rgba indexed(int index) {
  if (index >= 232) {
    const auto grey = static_cast<std::uint8_t>(8 + 10 * (index - 232));
    return {grey, grey, grey, 255};
  }
  constexpr std::uint8_t kSteps[] = {0, 95, 135, 175, 215, 255};
  index -= 16;
  return {kSteps[index / 36], kSteps[index / 6 % 6], kSteps[index % 6], 255};
}

/// The colours of a cell and how SGR sequences change them.
struct Pen {
  Rgba front{}, back{};  ///< transparent: the terminal's own
  bool inverse = false;

  bool apply(const std::vector<int>& numbers) {
    if (numbers.empty()) *this = {};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const int n = numbers[i];
      if (n == 0) *this = {};
      if (n == 7) inverse = true;
      if (n == 0 || n == 7) continue;
      if ((n != 38 && n != 48) || i + 2 >= numbers.size()) return false;
      Rgba& color = n == 38 ? front : back;
      if (numbers[i + 1] == 5 && numbers[i + 2] >= 16 && numbers[i + 2] < 256) {
        color = indexed(numbers[i + 2]);
        i += 2;
      } else if (numbers[i + 1] == 2 && i + 4 < numbers.size()) {
        for (int k = 0; k < 3; ++k) color[k] = static_cast<std::uint8_t>(numbers[i + 2 + k]);
        color[3] = 255;
        i += 4;
      } else {
        return false;
      }
    }
    return true;
  }
};

/// Which quarters of a cell the character at `at` fills: bits for upper left, upper right, lower left, lower
/// right. -1 if it is another one. `at` then is behind it.
int quarters(const std::string& line, std::size_t& at) {
  static const std::map<std::string, int> kKnown{{"▀", 3}, {"▄", 12}, {"▌", 5}, {"▐", 10}, {"█", 15},
                                                 {"▖", 4}, {"▗", 8},  {"▘", 1}, {"▙", 13}, {"▚", 9},
                                                 {"▛", 7}, {"▜", 11}, {"▝", 2}, {"▞", 6},  {"▟", 14}};
  if (line[at] == ' ') return ++at, 0;
  const auto found = kKnown.find(line.substr(at, 3));
  if (found == kKnown.end()) return -1;
  at += 3;
  return found->second;
}

/// The upper and the lower pixels of a line of cells.
using PixelRows = std::array<std::vector<Rgba>, 2>;

/// False for characters and sequences that are not known here.
bool read_line(const std::string& line, PixelRows& rows) {
  Pen pen;
  for (std::size_t at = 0; at < line.size();) {
    if (line[at] == '\x1b') {
      const std::size_t end = line.find_first_of("mb", at);
      if (end == std::string::npos || at + 1 >= line.size() || line[at + 1] != '[') return false;
      const std::vector<int> numbers = numbers_of(line.substr(at, end - at));
      at = end + 1;
      if (line[end] == 'm' && !pen.apply(numbers)) return false;
      if (line[end] == 'm') continue;
      // Repeats the last character.
      for (int n = 0; n < numbers.at(0); ++n)
        for (std::vector<Rgba>& row : rows) {
          if (row.size() < 2) return false;
          const Rgba left = row[row.size() - 2], right = row.back();
          row.push_back(left), row.push_back(right);
        }
      continue;
    }
    const int filled = quarters(line, at);
    if (filled < 0) return false;
    const Rgba front = pen.inverse ? pen.back : pen.front, back = pen.inverse ? pen.front : pen.back;
    for (int k = 0; k < 4; ++k) rows[k / 2].push_back(filled >> k & 1 ? front : back);
  }
  return true;
}

}  // namespace

std::string decode_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) return "";
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xff);
  }
  return bytes;
}

std::optional<ShownPicture> find_kitty(const std::string& text) {
  ShownPicture picture;
  std::string bytes;
  std::size_t at = 0;
  while (const auto chunk = next_between(text, "\x1b_G", "\x1b\\", at)) {
    const std::size_t end = std::min(chunk->find(';'), chunk->size());
    std::istringstream keys(chunk->substr(0, end));
    for (std::string key; std::getline(keys, key, ',');) {
      if (key.starts_with("f=") && key != "f=32") return std::nullopt;
      for (const auto& [name, value] : {std::pair{"s=", &picture.width},
                                        {"v=", &picture.height},
                                        {"c=", &picture.columns},
                                        {"r=", &picture.rows}})
        if (key.starts_with(name)) *value = std::stoi(key.substr(2));
    }
    if (end < chunk->size()) bytes += decode_base64(chunk->substr(end + 1));
  }
  if (bytes.empty() || bytes.size() != std::size_t{4} * picture.width * picture.height) return std::nullopt;
  picture.rgba.assign(bytes.begin(), bytes.end());
  return picture;
}

std::string find_iterm(const std::string& text) {
  std::size_t at = 0;
  const auto file = next_between(text, "\x1b]1337;File=", "\x07", at);
  if (!file || file->find(':') == std::string::npos) return "";
  return decode_base64(file->substr(file->find(':') + 1));
}

std::optional<ShownPicture> find_sixel(const std::string& text) {
  std::size_t at = 0;
  const auto all = next_between(text, "\x1bP", "\x1b\\", at);
  if (!all || all->find('q') == std::string::npos) return std::nullopt;
  const std::string data = all->substr(all->find('q') + 1);
  ShownPicture picture;
  std::map<int, Rgba> palette;
  Rgba color{};
  int x = 0, y = 0, repeats = 1;
  for (std::size_t i = 0; i < data.size();) {
    const char c = data[i++];
    const std::size_t end = std::min(data.find_first_not_of("0123456789;", i), data.size());
    const std::vector<int> numbers = numbers_of(data.substr(i, end - i));
    if (c == '"' || c == '#' || c == '!') i = end;
    if (c == '"' && numbers.size() == 4) {
      picture.width = numbers[2], picture.height = numbers[3];
      picture.rgba.resize(std::size_t{4} * picture.width * picture.height);
    } else if (c == '#' && numbers.size() == 5 && numbers[1] == 2) {
      Rgba& entry = palette[numbers[0]] = {0, 0, 0, 255};
      for (int k = 0; k < 3; ++k) entry[k] = static_cast<std::uint8_t>((numbers[2 + k] * 255 + 50) / 100);
    } else if (c == '#' && numbers.size() == 1 && palette.contains(numbers[0])) {
      color = palette[numbers[0]];
    } else if (c == '!' && numbers.size() == 1) {
      repeats = numbers[0];
    } else if (c == '$' || c == '-') {
      x = 0, y += c == '-' ? 6 : 0;
    } else if (c >= '?' && c <= '~') {
      for (; repeats > 0; --repeats, ++x)
        for (int k = 0; k < 6; ++k)
          if ((c - '?') >> k & 1 && x < picture.width && y + k < picture.height)
            std::ranges::copy(color, &picture.rgba[4 * (std::size_t(y + k) * picture.width + x)]);
      repeats = 1;
    } else {
      return std::nullopt;
    }
  }
  return picture;
}

std::optional<ShownPicture> find_blocks(const std::string& text) {
  ShownPicture picture;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.find("\x1b[") == std::string::npos || line.find("8;") == std::string::npos) continue;
    PixelRows rows;
    if (!read_line(line, rows)) return std::nullopt;
    picture.width = std::max(picture.width, static_cast<int>(rows[0].size()));
    if (static_cast<int>(rows[0].size()) != picture.width) return std::nullopt;
    for (const std::vector<Rgba>& row : rows)
      for (const Rgba& pixel : row) picture.rgba.insert(picture.rgba.end(), pixel.begin(), pixel.end());
    picture.height += 2, ++picture.rows;
  }
  if (picture.rows == 0) return std::nullopt;
  picture.columns = picture.width / 2;
  return picture;
}

}  // namespace oktett::test
