#include "app/text.h"

#include <algorithm>
#include <cmath>

#include "io/yaml/utf8.h"

namespace oktett {

static std::string three_digits(double value) {
  if (value >= 100) return fmt::format("{:.0f}", value);
  return value >= 10 ? fmt::format("{:.1f}", value) : fmt::format("{:.2f}", value);
}

std::string with_prefix(double value) {
  if (!std::isfinite(value)) return "- ";
  if (value < 1000) return fmt::format("{:.0f} ", value);
  const char* prefix = "kMGTPE";
  value /= 1000;
  // Otherwise 999.6 would be printed as 1000 of the smaller unit.
  for (; value >= 999.5 && prefix[1] != '\0'; ++prefix) value /= 1000;
  return three_digits(value) + " " + *prefix;
}

std::string grouped(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, 1, ',');
  return digits;
}

std::string duration_text(double seconds) {
  if (!std::isfinite(seconds)) return "-";
  if (seconds < 0.9995) return fmt::format("{:.3f} s", seconds);
  if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<std::uint64_t>(std::lround(seconds));
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

double parse_amount(std::string_view option, std::string_view text, std::string_view unit, double least,
                    double most) {
  double amount = 0;
  if (!parse_number(text, amount) || !(amount >= least && amount <= most))
    throw Error(fmt::format("{}: '{}' is out of range; expected {} from {:g} to {:g}", option, text, unit,
                            least, most));
  return amount;
}

std::string printable(std::string_view text) {
  std::string out;
  for (std::size_t i = 0, size; i < text.size(); i += size) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[i + k]); };
    const std::size_t length = character_length(text, i);
    size = std::max<std::size_t>(length, 1);
    // U+0080 to U+009F are control characters, too.
    const bool is_control = length == 1
                                ? (byte(0) < 0x20 && byte(0) != '\n' && byte(0) != '\t') || byte(0) == 0x7f
                            : length == 2 ? byte(0) == 0xc2 && byte(1) < 0xa0
                                          : length == 0;
    if (!is_control) out += text.substr(i, size);
    for (std::size_t k = 0; is_control && k < size; ++k) out += fmt::format("\\x{:02x}", byte(k));
  }
  return out;
}

void print_warnings(const std::vector<Warning>& warnings, std::size_t most) {
  const std::size_t shown = std::min(warnings.size(), most);
  for (std::size_t i = 0; i < shown; ++i) say("{}\n", printable(to_string(warnings[i])));
  if (warnings.size() > shown) say("... and {} more warnings\n", warnings.size() - shown);
}

}  // namespace oktett
