#pragma once
/// \file Text for people: numbers with units, warnings.

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/error.h"

namespace oktett {

/// "950", "12.3 k", "4.56 M", "7.89 G": three digits and a decimal prefix.
std::string with_prefix(double value);
/// "12.3 MB"; decimal prefixes.
inline std::string bytes_text(std::uint64_t bytes) { return with_prefix(static_cast<double>(bytes)) + "B"; }
/// "1,234,567".
std::string grouped(std::uint64_t value);
/// "0.123 s", "12.3 s", "2 min 05 s", "3 h 07 min".
std::string duration_text(double seconds);

/// Reads a number. False unless all of `text` belongs to it and it is in the range of its type.
template <class T>
bool parse_number(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

/// The number given to an option. Throws Error unless it is from `least` to `most`; the message names the
/// option and the unit.
double parse_amount(std::string_view option, std::string_view text, std::string_view unit, double least,
                    double most);

/// What a file says, as a terminal may show it: without control characters, which are written as \x1b, but
/// for the ends of lines and tabs.
std::string printable(std::string_view text);

/// Prints to stderr, formatted as by fmt. A message that nobody can read is no reason to lose a picture, so a
/// closed or full stream is no error.
template <class... T>
void say(fmt::format_string<T...> format, T&&... values) {
  const std::string text = fmt::format(format, std::forward<T>(values)...);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

/// Prints what a scene says itself to stderr.
inline void say_as_is(const std::string& text) { say("{}", printable(text)); }

/// Prints the first `most` warnings to stderr, and the number of the others.
void print_warnings(const std::vector<Warning>& warnings, std::size_t most = 20);

}  // namespace oktett
