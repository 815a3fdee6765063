#pragma once
/// \file What describes the surface of a function of the user's own.

#include "core/vec3.h"
#include "kernels/functions/tape_data.h"

namespace oktett {

/// Where a function of x, y and z is negative, in a box. Where it is not defined is outside.
struct ImplicitShape {
  FunctionTape function;
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};  ///< lo < hi
  bool open = false;                  ///< without the faces of the box
};

}  // namespace oktett
