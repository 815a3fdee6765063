#pragma once
/// \file What a curve or a sphere passes over as it moves: prisms, letters and sphere sweeps. Within io/
/// only.

#include <optional>

#include "io/pov/translate/shapes.h"

namespace oktett::pov {

/// Reads the arguments of a `prism`, a `text` or a `sphere_sweep` up to its modifiers. Nothing, after a
/// warning, if it has no volume or its font is not read.
std::optional<Shapes> make_sweep(Context& context, Arguments& arguments);

}  // namespace oktett::pov
