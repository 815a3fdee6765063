#pragma once
/// \file What describes a convex polyhedron.

#include <vector>

#include "core/vec3.h"

namespace oktett {

/// All points p with normal . p <= offset; the normal need not have unit length.
struct HalfSpace {
  Vec3d normal;
  double offset;
};

/// What all of the half-spaces have in common; bounded, with an inside.
struct PolyhedronShape {
  std::vector<HalfSpace> planes;
};

}  // namespace oktett
