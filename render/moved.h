#pragma once
/// \file Cameras and lights that have been moved.

#include "render/scene.h"

namespace oktett {

/// The camera at a time.
Camera camera_at(const Camera& camera, double time);

/// A light as a transform moves it. Environments and skies stay.
Light moved_light(const Affine& motion, const Light& light);

}  // namespace oktett
