#pragma once
/// \file Functions of numbers, which expressions and functions of a scene share.

#include <span>
#include <string_view>

#include "io/pov/document.h"

namespace oktett::pov {

struct NumericFunction {
  std::string_view name;
  std::size_t least, most;  ///< how many values it takes
  double (*value)(std::span<const double>);
};

/// Null if there is none of this name.
const NumericFunction* find_numeric(std::string_view name);

inline Numbers number(double x) { return {{x}, 1, false}; }

/// Componentwise `+`, `-`, `*` or `/`: numbers become vectors of equal components, shorter vectors get zeros.
Numbers combine(char operation, const Numbers& a, const Numbers& b);

/// The weights of red, green and blue in POV-Ray's `gray`.
inline constexpr double kGray[3] = {0.297, 0.589, 0.114};

/// Which component `.x`, `.red`, ... stands for; -1 for `.gray`, -2 if it is none.
int component_index(std::string_view name);

}  // namespace oktett::pov
