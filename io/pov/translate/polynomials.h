#pragma once
/// \file Polynomials of POV-Ray: cubic, quartic and poly. Within io/ only.

#include <optional>

#include "io/pov/translate/shapes.h"

namespace oktett::pov {

/// Reads the arguments of a polynomial up to its modifiers; `degree` 0 is given first. It is bounded by
/// `within`, and, where that is endless, by what surely holds all of it if that is found, else at 1000.
/// Nothing, after a warning, if its degree is too high or it is constant.
std::optional<Shapes> make_polynomial(Context& context, Arguments& arguments, int degree,
                                      const Extent& within, bool operand);

}  // namespace oktett::pov
