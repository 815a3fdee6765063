#pragma once
/// \file What a finished picture that shows nothing tells of its reason.

#include <string>

#include "render/picture/render.h"

namespace oktett {

/// Why the picture of a whole frame shows no object or no light, or what it seems to be; empty if it shows
/// some.
std::string why_nothing_is_seen(const RenderResult& result);

}  // namespace oktett
