#include "io/scene/number_line.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "io/text/scan.h"

namespace oktett {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

}  // namespace

NumberLine::NumberLine(std::string_view line, const Location& place, const char* expected)
    : line_(line), place_(place), expected_(expected) {
  skip_space();
}

double NumberLine::number() {
  if (empty()) fail(at_, std::string("expected ") + expected_ + ", found fewer");
  double value = 0;
  const std::size_t begin = at_ + (line_[at_] == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(line_.data() + begin, line_.data() + line_.size(), value);
  const auto stop = static_cast<std::size_t>(end - line_.data());
  const bool ends_word = stop == line_.size() || is_space(line_[stop]) || line_[stop] == '#';
  if (error == std::errc::invalid_argument || !ends_word) fail(at_, "expected a number");
  if (error != std::errc() || !(std::abs(value) <= kMaxCoordinate))
    fail(at_, "number not finite or out of range");
  previous_ = at_;
  at_ = stop;
  skip_space();
  return value;
}

void NumberLine::finish() const {
  if (!empty()) fail(at_, std::string("expected ") + expected_ + ", found more");
}

void NumberLine::skip_space() {
  while (at_ < line_.size() && is_space(line_[at_])) ++at_;
}

void NumberLine::fail(std::size_t at, const std::string& message) const {
  Location place = place_;
  place.column = static_cast<int>(at) + 1;
  throw Error(place, message);
}

void read_number_file(SceneLoad& load, const YamlNode& node, std::size_t max_bytes, const char* files,
                      const char* expected, const std::function<void(NumberLine&)>& read) {
  const std::string path = load.values.existing_file(node);
  const std::string text = read_text_file(path, max_bytes);
  load.sphere_file_bytes += text.size();
  if (load.sphere_file_bytes > kMaxSphereFileBytes)
    throw Error(node.where(), std::string(files) + " are larger than " +
                                  std::to_string(kMaxSphereFileBytes >> 20) + " MiB in all");
  Location place{path, 0, 1};
  std::size_t end = 0;
  for (std::size_t begin = text.size() - without_byte_order_mark(text).size(); begin < text.size();
       begin = end + 1) {
    end = std::min(text.find('\n', begin), text.size());
    ++place.line;
    NumberLine line(std::string_view(text).substr(begin, end - begin), place, expected);
    if (!line.empty()) attempt(node, [&] { read(line); });
  }
}

}  // namespace oktett
