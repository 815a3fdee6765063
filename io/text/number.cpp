#include "io/text/number.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

namespace oktett {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Whether the decimal number [p, end), which a float cannot hold, is too great for it rather than too small.
/// Only the place of its first digit that is not 0 matters.
bool is_too_great(const char* p, const char* end) {
  std::int64_t place = 0;
  bool point = false, found = false;
  for (; p < end && (is_digit(*p) || *p == '.'); ++p) {
    if (*p == '.') {
      point = true;
    } else {
      found = found || *p != '0';
      if (found && !point) ++place;
      if (!found && point) --place;
    }
  }
  if (p == end) return place > 0;
  constexpr std::int64_t most = 1'000'000'000'000;
  const bool negative = p[1] == '-';
  std::uint64_t magnitude = 0;
  scan_long_whole(p + 1 + (negative || p[1] == '+' ? 1 : 0), magnitude);
  const auto exponent = static_cast<std::int64_t>(std::min(magnitude, static_cast<std::uint64_t>(most)));
  return place + (negative ? -exponent : exponent) > 0;
}

/// `1.#IND`, `1.#QNAN` and `1.#INF` with trailing digits, as older Windows C libraries print them; null for
/// all else.
const char* scan_windows_special(const char* p, float& value) {
  for (const std::string_view name : {"1.#IND", "1.#QNAN", "1.#SNAN", "1.#INF"}) {
    if (std::string_view(p, find_line_end(p)).substr(0, name.size()) != name) continue;
    value =
        name == "1.#INF" ? std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
    p += name.size();
    while (is_digit(*p)) ++p;
    return is_delimiter(p) ? p : nullptr;
  }
  return nullptr;
}

}  // namespace

const char* scan_float_exactly(const char* p, float& value, NumberProblem& problem) {
  problem = NumberProblem::malformed;
  const bool negative = *p == '-';
  p += negative || *p == '+' ? 1 : 0;
  if (*p == '-' || *p == '+') return nullptr;

  float magnitude = 0;
  if (const char* end = scan_windows_special(p, magnitude)) {
    problem = NumberProblem::none;
    value = negative ? -magnitude : magnitude;
    return end;
  }
  const auto [end, error] = std::from_chars(p, find_line_end(p), magnitude);
  if (error == std::errc::invalid_argument || !is_delimiter(end)) return nullptr;
  // Libraries differ in what they report and store when a number leaves the range.
  const bool decimal = is_digit(*p) || *p == '.';
  if (decimal && (error == std::errc::result_out_of_range || std::isinf(magnitude))) {
    if (is_too_great(p, end)) {
      problem = NumberProblem::overflow;
      return nullptr;
    }
    magnitude = 0;
  }
  problem = NumberProblem::none;
  value = negative ? -magnitude : magnitude;
  return end;
}

const char* scan_double(const char* p, double& value) {
  const bool negative = *p == '-';
  p += negative || *p == '+' ? 1 : 0;
  double magnitude = 0;
  const auto [end, error] = std::from_chars(p, find_line_end(p), magnitude);
  if (error == std::errc::result_out_of_range) magnitude = 0;  // as a float it was 0, too
  value = negative ? -magnitude : magnitude;
  return end;
}

const char* scan_long_whole(const char* p, std::uint64_t& value) {
  constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  value = 0;
  for (; is_digit(*p); ++p) {
    const auto digit = static_cast<std::uint64_t>(*p - '0');
    value = value > (most - digit) / 10 ? most : value * 10 + digit;
  }
  return p;
}

}  // namespace oktett
