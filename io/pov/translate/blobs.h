#pragma once
/// \file Blobs as metaballs. Within io/ only.

#include <optional>

#include "io/pov/translate/shapes.h"

namespace oktett::pov {

/// Reads the arguments of a `blob` up to its modifiers. Nothing, after a warning, if it has no surface.
std::optional<Shapes> make_blob(Context& context, Arguments& arguments);

}  // namespace oktett::pov
