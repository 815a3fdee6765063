#pragma once
/// \file What describes a cone or a frustum.

#include "core/description.h"
#include "core/vec3.h"

namespace oktett {

/// As a cylinder, with a radius at each end; a radius of 0 makes a tip.
struct ConeShape {
  Vec3d from{0, -1, 0}, to{0, 1, 0};
  double from_radius = 1, to_radius = 0;
  bool open = false;

  static constexpr ShapeInfo kShapeInfo{"cone", "a cone, or a part of one that is cut off at both ends"};
  void describe(auto& p) {
    p.field("from", from, kCoordinate, "one end of the axis");
    p.field("to", to, kCoordinate, "the other end");
    p.field("from_radius", from_radius, kLength, "radius at `from`; 0 makes a tip");
    p.field("to_radius", to_radius, kLength, "radius at `to`; 0 makes a tip");
    p.field("open", open, "without the disks at the ends");
    p.normals();
    p.nothing_if(from_radius == 0 && to_radius == 0, "both radii are zero");
    p.nothing_if(!(length(to - from) > 0), "the ends of the axis coincide");
  }
};

}  // namespace oktett
