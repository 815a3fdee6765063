#pragma once
/// \file What shapes answer that are asked for their point nearest to a given one.

#include <limits>

#include "core/vec3.h"

namespace oktett {

/// A point of a surface, as the nearest to another one. Where several points are nearest, such as all points
/// of a sphere to its centre, the choice follows from the numbers alone.
struct SurfaceNearest {
  double d2 = std::numeric_limits<double>::infinity();  ///< squared distance
  Vec3d point, normal;                                  ///< the normal has unit length and points outwards
};

}  // namespace oktett
