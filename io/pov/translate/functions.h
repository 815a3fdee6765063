#pragma once
/// \file Functions as expressions of scene files. Within io/ only.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "io/pov/translate/context.h"
#include "kernels/functions/tape_data.h"

namespace oktett::pov {

/// A function of x, y and z, or of other variables, as an expression in these, less `threshold`. Nothing,
/// after a warning, if it uses what expressions do not have, or is too long.
std::optional<std::string> function_text(Context& context, const Function& function, const Place& where,
                                         double threshold = 0,
                                         std::span<const std::string_view> variables = kSpaceVariables);

/// A function of the colour that a pigment has at the place: in x, y and z for its red, green and blue.
struct ColorFunction {
  std::string text;
  std::shared_ptr<const Block> pigment;
};
/// Nothing if it is none.
std::optional<ColorFunction> function_of_pigment(Context& context, const Function& function);

}  // namespace oktett::pov
