#pragma once
/// \file What describes a quadric.

#include <array>

#include "core/vec3.h"

namespace oktett {

/// A x^2 + B y^2 + C z^2 + D xy + E xz + F yz + G x + H y + I z + J <= 0 (slides: x^2 + y^2 = 1,
/// x^2 + y^2 - z = 0, x^2 + y^2 - z^2 = 1).
struct QuadricShape {
  std::array<double, 10> coefficients{1, 1, 1, 0, 0, 0, 0, 0, 0, -1};  ///< A to J
  bool clipped = false;
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};  ///< lo < hi; nothing is outside of this box if `clipped`
  bool open = false;                  ///< without the faces of the box, which otherwise close the solid
};

}  // namespace oktett
