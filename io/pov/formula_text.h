#pragma once
/// \file The text of expressions, put together. Within io/ only.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace oktett::pov {

/// `text` with operands in the place of their numbers, $0 to $9, each in parentheses; all in parentheses.
std::string filled(std::string_view text, const std::vector<std::string>& operands);

/// The value of an operand that is a number, perhaps in parentheses.
std::optional<double> constant(std::string_view text);

}  // namespace oktett::pov
