#pragma once
/// \file Areas of the plane between loops, such as letters and the ends of prisms, as triangles. Within io/
/// only.

#include <functional>
#include <vector>

namespace oktett::pov {

struct PlainPoint {
  double x, y;
};
using Loop = std::vector<PlainPoint>;

/// A loop, and if it is smooth the directions in which it goes on at its points.
struct Outline {
  Loop points;
  std::vector<PlainPoint> tangents;
};

/// Greater than 0 if the loop turns to the left.
double area(const Loop& loop);

/// Calls add(a, b, c) for triangles, turned to the left, that cover what lies inside of an odd number of
/// loops. Triangles meet edge to edge. Loops that cross each other get further points.
void fill(std::vector<Outline>& outlines, const std::function<void(PlainPoint, PlainPoint, PlainPoint)>& add);

}  // namespace oktett::pov
