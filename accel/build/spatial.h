#pragma once
/// \file Splits of space: a triangle that crosses the plane becomes two references with tighter boxes (Stich,
/// Friedrich and Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009).

#include <vector>

#include "accel/build/wide_tree.h"

namespace oktett {

/// The plane at `place` across an axis, and what the two sides come to; axis < 0: none.
struct SpatialSplit {
  int axis = -1;
  float place = 0;
  double cost = std::numeric_limits<double>::infinity();  ///< areas times blocks of eight, as of `unit` 1
  Box side[2];
  std::size_t count[2] = {};
};

/// Half the surface of a box in double, where no float overflows.
double half_area(const Box& box);

/// Of planes at equal distances, the one of least surface-area cost. `box` bounds refs[0, count).
SpatialSplit find_spatial(const PrimRef* refs, std::size_t count, const Box& box,
                          const TriangleSource& triangles, bool parallel);

/// Copies refs[0, count) to `left` upwards and to `right` downwards (the first goes to right[-1]). Of a
/// triangle that crosses the plane both parts are kept, or, where that is cheaper, the whole on one side.
/// At most `room` - 1 references are left on each side together; where they would be more, or one side would
/// be empty, nothing is done. Returns how many went left and right, {0, 0} for nothing.
struct SpatialParts {
  std::size_t left = 0, right = 0;
};
SpatialParts partition_spatial(const PrimRef* refs, std::size_t count, std::size_t room,
                               const SpatialSplit& split, const TriangleSource& triangles, PrimRef* left,
                               PrimRef* right);

}  // namespace oktett
