#pragma once
/// \file Surfaces of two parameters: bicubic_patch and parametric. Within io/ only.

#include <optional>

#include "io/pov/translate/shapes.h"

namespace oktett::pov {

/// Reads the arguments of such an object up to its modifiers. Nothing, after a warning, if there is nothing
/// to see of it.
std::optional<Shapes> make_patch(Context& context, Arguments& arguments);
std::optional<Shapes> make_parametric(Context& context, Arguments& arguments);

}  // namespace oktett::pov
