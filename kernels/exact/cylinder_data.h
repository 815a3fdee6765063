#pragma once
/// \file What describes a cylinder.

#include "core/description.h"
#include "core/vec3.h"

namespace oktett {

/// All points nearer than `radius` to the line from `from` to `to`, cut off flat at its ends.
struct CylinderShape {
  Vec3d from{0, -1, 0}, to{0, 1, 0};
  double radius = 1;
  bool open = false;

  static constexpr ShapeInfo kShapeInfo{"cylinder", "a round column between two points"};
  void describe(auto& p) {
    p.field("from", from, kCoordinate, "one end of the axis");
    p.field("to", to, kCoordinate, "the other end");
    p.field("radius", radius, kLength, "distance of the surface from the axis");
    p.field("open", open, "without the disks at the ends");
    p.normals();
    p.nothing_if(radius == 0, "the radius is zero");
    p.nothing_if(!(length(to - from) > 0), "the ends of the axis coincide");
  }
};

}  // namespace oktett
