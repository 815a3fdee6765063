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

/// The up direction of a mesh whose file does not state one: +y, as is usual, unless the mesh has a flat base
/// at the low end of z and none at the low end of y; then +z.
Vec3d guess_up(const TriangleMesh& mesh);

/// A key light from above left of the camera and a weaker fill light from its right.
std::vector<Light> default_lights(const Camera& camera, const Film& film);

}  // namespace oktett
