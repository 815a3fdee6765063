#pragma once
/// \file Points in a plane, and exactly on which side of a line they lie.

namespace oktett {

struct PlanePoint {
  double x, y;
  bool operator==(const PlanePoint&) const = default;
};

/// Twice the area of the triangle, positive if it turns to the left; rounded.
inline double cross(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Its sign, exact for points whose coordinates are floats: 1 if it turns to the left, 0 if there is no area.
/// By the error bound and the expansions of Shewchuk 1997.
int orientation(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c);

}  // namespace oktett
