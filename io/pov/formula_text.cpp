#include "io/pov/formula_text.h"

#include <charconv>

namespace oktett::pov {

std::string filled(std::string_view text, const std::vector<std::string>& operands) {
  std::string out = "(";
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '$') {
      out += text[i];
      continue;
    }
    out += '(' + operands[static_cast<std::size_t>(text[++i] - '0')] + ')';
  }
  return out + ')';
}

std::optional<double> constant(std::string_view text) {
  while (text.size() > 1 && text.front() == '(' && text.back() == ')') text = text.substr(1, text.size() - 2);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace oktett::pov
