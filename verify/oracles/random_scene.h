#pragma once
/// \file Random scenes of shapes of all kinds.

#include <cstdint>

#include "render/scene.h"
#include "verify/cases/kernel_cases.h"

namespace oktett {

/// Scene number `number`: up to a dozen objects under random transforms, among them prototypes with instances
/// in them, combinations, and rows of instances; the whole scene may be far away, tiny or huge. Objects that
/// are known shapes have their names, see known_shapes.h.
Scene draw_scene(std::uint64_t number);

}  // namespace oktett
