#pragma once
/// \file Spatial splits: a triangle that crosses the plane becomes two references with tighter boxes (Stich,
/// Friedrich and Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009).

#include <vector>

#include "accel/build/triangle_source.h"

namespace oktett {

/// The plane at `place` across an axis, and the cost of the split there; axis < 0: none.
struct SpatialSplit {
  int axis = -1;
  float place = 0;
  double cost = std::numeric_limits<double>::infinity();  ///< areas times blocks of eight, as of `unit` 1
  Box side[2];
  std::size_t count[2] = {};
};

/// Half the surface of a box in double, where no float overflows.
double half_area(const Box& box);

/// The plane of least surface-area cost among equidistant ones across the longest axis of `box`, which bounds
/// refs[0, count), or across every axis.
SpatialSplit find_spatial(const PrimRef* refs, std::size_t count, const Box& box,
                          const TriangleCorners& triangles, bool every_axis, bool parallel);

/// Copies refs[0, count) to `left` upwards and to `right` downwards (the first goes to right[-1]). A triangle
/// that crosses the plane becomes a reference on each side or, where that is cheaper, a whole one on one
/// side. Returns the numbers of references on the left and on the right. Returns {0, 0}, without a split, if
/// there would be `room` or more together or none on one side.
struct SpatialParts {
  std::size_t left = 0, right = 0;
};
SpatialParts partition_spatial(const PrimRef* refs, std::size_t count, std::size_t room,
                               const SpatialSplit& split, const TriangleCorners& triangles, PrimRef* left,
                               PrimRef* right);

}  // namespace oktett
