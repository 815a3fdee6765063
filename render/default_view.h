#pragma once
/// \file A camera and lights for scenes that state none.

#include <vector>

#include "core/box.h"
#include "render/scene.h"

namespace oktett {

/// A camera that looks at the centre of `bounds` from a three-quarter view, as near as it can be with all of
/// the box in the frame. Field of view, projection and up direction are those of `given`. Empty or non-finite
/// bounds count as the box from -1 to 1.
Camera frame_bounds(const Box& bounds, const Camera& given, const Film& film);

/// A key light from above left of the camera and a weaker fill light from its right.
std::vector<Light> default_lights(const Camera& camera, const Film& film);

}  // namespace oktett
