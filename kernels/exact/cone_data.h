#pragma once
/// \file What describes a cone or a frustum.

#include "core/vec3.h"

namespace oktett {

/// As a cylinder, with a radius at each end; a radius of 0 makes a tip.
struct ConeShape {
  Vec3d from{0, -1, 0}, to{0, 1, 0};      ///< different
  double from_radius = 1, to_radius = 0;  ///< >= 0, not both 0
  bool open = false;                      ///< without the ends
};

}  // namespace oktett
