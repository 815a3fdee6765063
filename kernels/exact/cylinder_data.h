#pragma once
/// \file What describes a cylinder.

#include "core/vec3.h"

namespace oktett {

/// All points nearer than `radius` to the line from `from` to `to`, cut off flat at its ends.
struct CylinderShape {
  Vec3d from{0, -1, 0}, to{0, 1, 0};  ///< different
  double radius = 1;                  ///< > 0
  bool open = false;                  ///< without the ends
};

}  // namespace oktett
