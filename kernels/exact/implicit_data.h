#pragma once
/// \file What describes the surface of a function of the user's own.

#include "core/description.h"
#include "core/vec3.h"
#include "kernels/functions/tape_data.h"

namespace oktett {

/// Where a function of x, y and z is negative, in a box. Where it is not defined is outside.
struct ImplicitShape {
  FunctionTape function;
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};  ///< lo < hi
  bool open = false;                  ///< without the faces of the box

  static constexpr ShapeInfo kShapeInfo{"implicit", "the zeros of a function"};
  void describe(auto& p) {
    p.required("function", function, "negative inside; at most 1024 steps after common parts are shared");
    p.required("bounds", SolidBox{lo, hi}, "the box that cuts it, and whose faces close it");
    p.field("open", open, "without the faces of the box");
    p.normals();
    p.nothing_if(!function.varies, "the function does not depend on x, y or z");
  }
};

}  // namespace oktett
