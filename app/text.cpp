#include "app/text.h"

#include <algorithm>
#include <cmath>

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

void print_warnings(const std::vector<Warning>& warnings, std::size_t most) {
  const std::size_t shown = std::min(warnings.size(), most);
  for (std::size_t i = 0; i < shown; ++i) say("{}\n", to_string(warnings[i]));
  if (warnings.size() > shown) say("... and {} more warnings\n", warnings.size() - shown);
}

}  // namespace oktett
