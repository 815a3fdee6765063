#pragma once
/// \file Polynomials of POV-Ray: cubic, quartic and poly. Within io/ only.

#include <optional>

#include "io/pov/translate/shapes.h"

namespace oktett::pov {

/// Reads the arguments of a polynomial up to its modifiers; `degree` 0 is given first. It ends at `limits`,
/// and, where these are endless, at what surely holds all of it if that is found, else at 1000. So does one
/// that has no end but for what `bounded_by` names, unless it is an operand: that is a solid which a box with
/// an unseen surface cuts. Nothing, after a warning, if its degree is too high or it is constant.
std::optional<Shapes> make_polynomial(Context& context, Arguments& arguments, int degree,
                                      const ShapeLimits& limits, bool operand);

}  // namespace oktett::pov
