#pragma once
/// \file Sphereflakes (E. Haines: A Proposal for Standard Graphics Environments, 1987), as the union of their
/// balls.
///
/// The ray is taken from ball to ball into the space in which that ball has radius 1, each time with the
/// point nearest to its centre as its origin. So the rounding errors of a level are those of numbers of the
/// size of that level's ball, and at depth n a crossing is off by a few 2^-53 of the first ball, whatever n.

#include <vector>

#include "kernels/fractals/fractal.h"
#include "kernels/fractals/sphereflake_data.h"

namespace oktett {

struct SphereflakeElement {
  int depth;
  double ratio;
  /// Of each generation g: its balls' radius, and the radius, in their own spaces, of a ball about one of
  /// them that holds all its descendants.
  double radius[kMaxSphereflakeDepth + 1], reach[kMaxSphereflakeDepth + 1];
  /// How far the descendants of one of them, and itself, reach down and up along the y axis of its space.
  double low[kMaxSphereflakeDepth + 1], high[kMaxSphereflakeDepth + 1];
};

struct Sphereflake : Fractal<Sphereflake, SphereflakeShape, SphereflakeElement> {
  static void add(Pool& pool, const SphereflakeShape& shape, const ExactPlace& place);
  static int find(const Element& element, const FractalQuery& query, FractalCrossing* out, int room);
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  static Box world_bounds(const Pool& pool, std::size_t i);
};

}  // namespace oktett
