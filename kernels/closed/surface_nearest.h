#pragma once
/// \file What shapes answer that are asked for their point nearest to a given one.

#include <cmath>
#include <limits>

#include "core/vec3.h"

namespace oktett {

/// A point of a surface, as the nearest to another one. Where several points are nearest, such as all points
/// of a sphere to its centre, the choice follows from the numbers alone.
struct SurfaceNearest {
  double d2 = std::numeric_limits<double>::infinity();  ///< squared distance
  Vec3d point, normal;                                  ///< the normal has unit length and points outwards

  /// Takes `other` if it is nearer to p. Where two faces meet, that which faces p more counts, so that the
  /// side on which p lies follows from the normal.
  void keep_nearer(const Vec3d& p, const SurfaceNearest& other) {
    const auto facing = [&](const SurfaceNearest& s) { return std::abs(dot(p - s.point, s.normal)); };
    if (other.d2 < d2 || (other.d2 == d2 && facing(other) > facing(*this))) *this = other;
  }
};

}  // namespace oktett
