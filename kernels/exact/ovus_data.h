#pragma once
/// \file What describes an ovus.

#include "core/description.h"

namespace oktett {

/// An egg about the y axis: a ball of the bottom radius about the origin, a ball of the top radius about
/// (0, bottom radius, 0), and between them what a circular arc encloses that touches both from outside. The
/// radius of the arc is twice the greater one of the two.
struct OvusShape {
  double bottom_radius = 1, top_radius = 0.6;

  static constexpr ShapeInfo kShapeInfo{"ovus",
                                        "an egg about the y axis: two balls, and an arc turned around both"};
  void describe(auto& p) {
    p.field("bottom_radius", bottom_radius, kLength, "radius of the ball about the origin");
    p.field("top_radius", top_radius, kLength,
            "radius of the ball about the point that lies `bottom_radius` up the y axis; less than twice "
            "`bottom_radius`");
    p.normals();
    p.check(top_radius < 2 * bottom_radius || bottom_radius == 0, "top_radius",
            "the top radius must be less than twice the bottom radius; a ball of it holds the other one");
    p.nothing_if(bottom_radius == 0, "the bottom radius is zero");
    p.nothing_if(top_radius == 0, "the top radius is zero");
  }
};

}  // namespace oktett
