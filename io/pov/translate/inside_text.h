#pragma once
/// \file The insides of objects as functions, for the pattern `object`. Within io/ only.

#include <optional>
#include <string>

#include "io/pov/translate/context.h"

namespace oktett::pov {

/// An expression in x, y and z that is below 0 inside of an object, 0 on its surface and above 0 outside.
/// Nothing if it is made of other things than balls, boxes, planes, cylinders, cones, tori, quadrics and
/// combinations of these.
std::optional<std::string> inside_text(Context& context, const Block& object);

}  // namespace oktett::pov
