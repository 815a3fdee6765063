#pragma once
/// \file Values of functions, splines and transforms while a scene is read.

#include <span>

#include "io/pov/interpreter.h"

namespace oktett::pov {

/// Calls functions at a place of a scene.
class FunctionCaller {
 public:
  FunctionCaller(Interpreter& interpreter, const Place& where) : interpreter_(interpreter), where_(where) {}

  /// A number; a vector of `function { transform ... }`, a colour of `function { pigment ... }`.
  Numbers call(const Function& function, std::span<const double> arguments) const;

 private:
  Interpreter& interpreter_;
  Place where_;
};

/// Whether the function has components: that of a transform, a spline or a pigment.
bool has_components(const Function& function);

/// How many steps the value of a spline counts as.
std::uint64_t steps_of(const Spline& spline);

/// The kind that `linear_spline` and the like stand for. False: none.
bool spline_kind(Keyword keyword, Spline::Kind& kind);

/// Whether a colour starts with this word.
bool is_color_keyword(Keyword keyword);

}  // namespace oktett::pov
