#pragma once
/// \file Directions and places made from points of the unit square.

#include "core/vec3.h"
#include "render/sampling/square_sample.h"

namespace oktett {

/// A unit vector about the unit normal `n` with density cos(angle) / pi.
Vec3f cosine_direction(const Vec3f& n, const SquareSample& s);

/// A point of the unit disk, uniformly distributed: the concentric map of Shirley and Chiu (1997), which
/// keeps neighbours together. Coordinates in [-1, 1].
SquareSample disk_point(const SquareSample& s);

}  // namespace oktett
