#pragma once
/// \file The triangle that a ray has hit.

#include <array>
#include <optional>

#include "accel/accel.h"

namespace oktett {

/// The corners of the triangle at a hit, which is valid, in the space of `accel` and in the order of the
/// mesh; nothing if what was hit is no triangle.
std::optional<std::array<Vec3f, 3>> triangle_corners(const Accel& accel, const Hit& hit);

}  // namespace oktett
