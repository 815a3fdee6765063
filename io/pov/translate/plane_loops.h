#pragma once
/// \file Areas of the plane between loops, as triangles. Within io/ only.

#include <functional>
#include <vector>

namespace oktett::pov {

struct PlainPoint {
  double x, y;
};
using Loop = std::vector<PlainPoint>;

/// Greater than 0 if the loop turns to the left.
double area(const Loop& loop);

/// Calls add(a, b, c) for triangles, turned to the left, that cover what lies inside of an odd number of
/// loops. Triangles meet edge to edge.
void fill(std::vector<Loop> loops, const std::function<void(PlainPoint, PlainPoint, PlainPoint)>& add);

}  // namespace oktett::pov
