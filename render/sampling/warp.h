#pragma once
/// \file Directions and places made from points of the unit square.

#include "core/vec3.h"

namespace oktett {

/// A point of the unit square, [0, 1) in both coordinates.
struct SquareSample {
  double x = 0, y = 0;
};

/// A unit vector about the unit normal `n` with density cos(angle) / pi.
Vec3f cosine_direction(const Vec3f& n, const SquareSample& s);

/// A point of the unit disk, uniformly distributed: the concentric map of Shirley and Chiu (1997), which
/// keeps neighbours together. Coordinates in [-1, 1].
SquareSample disk_point(const SquareSample& s);

}  // namespace oktett
