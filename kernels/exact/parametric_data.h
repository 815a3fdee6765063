#pragma once
/// \file What describes a surface that is given by functions of two parameters.

#include "core/description.h"
#include "core/vec3.h"
#include "kernels/functions/tape_data.h"

namespace oktett {

/// A function of u and v.
struct UvFunction {
  FunctionTape tape;  ///< of x for u and y for v
};

/// The points (x, y, z) that functions of u and v make of a rectangle. Where one is not defined is nothing.
struct ParametricShape {
  UvFunction x, y, z;
  double from[2] = {0, 0}, to[2] = {1, 1};  ///< of u and v, from < to
  bool cut = false;                         ///< whether there is a box, outside of which nothing is seen
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};        ///< the box
  bool open = true;                         ///< else the surface surrounds a solid

  static constexpr ShapeInfo kShapeInfo{"parametric", "a surface given by functions of u and v"};
  void describe(auto& p) {
    p.required("x", x, "x of the point at (u, v)");
    p.required("y", y, "y of the point at (u, v)");
    p.required("z", z, "z of the point at (u, v)");
    p.field("from", from, "the least u and v");
    p.field("to", to, "the greatest u and v");
    p.check(from[0] < to[0], "to", "the greatest u must be greater than the least");
    p.check(from[1] < to[1], "to", "the greatest v must be greater than the least");
    cut = p.optional("clip", ClipBox{lo, hi}, "a box that cuts it");
    p.field("open", open,
            "`false`: the surface surrounds a solid, with no gaps, and does not pass through itself");
    p.check(open || !cut, "open", "a surface that is cut does not surround a solid");
    p.nothing_if(cut && !(lo.x < hi.x && lo.y < hi.y && lo.z < hi.z), "the clip box has no volume");
  }
};

}  // namespace oktett
