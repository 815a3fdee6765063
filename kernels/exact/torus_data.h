#pragma once
/// \file What describes a torus.

#include "core/description.h"

namespace oktett {

/// (major - sqrt(x^2 + y^2))^2 + z^2 = minor^2 (Zachmann 2010). With minor > major the surface meets itself
/// on the axis.
struct TorusShape {
  double major = 0.7, minor = 0.3;

  static constexpr ShapeInfo kShapeInfo{"torus", "a ring around the z axis"};
  void describe(auto& p) {
    p.field("major", major, kLength, "radius of the circle in the middle of the tube");
    p.field("minor", minor, kLength, "radius of the tube; one above `major` makes a ring that meets itself");
    p.normals();
    p.nothing_if(minor == 0, "the minor radius is zero");
  }
};

}  // namespace oktett
