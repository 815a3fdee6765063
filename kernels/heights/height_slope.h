#pragma once
/// \file How far points are above a height field, and how that changes.

#include "kernels/heights/height_cell.h"

namespace oktett::height {

/// The function whose zeros a part of the element is, negative inside, and its gradient.
template <class D>
void slope(const HeightFieldElement& e, const D& part, const Vec3<D>& p, D& value, Vec3<D>& gradient) {
  const Vec3d &scale = e.frame.scale, &shift = e.frame.shift;
  const HeightPatch<D> patch(*e.grid, p.x * D(scale.x) + D(shift.x), p.z * D(scale.z) + D(shift.z));
  value = p.y - (patch.height - D(shift.y)) / D(scale.y);
  gradient = {-patch.by_x * D(scale.x / scale.y), D(1.0), -patch.by_z * D(scale.z / scale.y)};

  const D zero(0.0);
  const auto others = zero < part;
  if (none(others)) return;
  const auto set = [&](const typename D::M& where, const D& to, const D& x, const D& y, const D& z) {
    value = select(where, to, value);
    gradient = {select(where, x, gradient.x), select(where, y, gradient.y), select(where, z, gradient.z)};
  };
  const D* at[3] = {&p.x, &p.y, &p.z};
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      const D side(high ? 1.0 : -1.0), bound(high ? e.hi[axis] : e.lo[axis]);
      const D x = axis == 0 ? side : zero, y = axis == 1 ? side : zero, z = axis == 2 ? side : zero;
      set(part == D(1.0 + 2 * axis + (high ? 1 : 0)), (*at[axis] - bound) * side, x, y, z);
      if (axis == 1) continue;
      // The line of the grid that is nearest.
      const D shifter(0x1.8p52), line = *at[axis] * D(scale[axis]) + D(shift[axis]);
      const D wall = (((line + shifter) - shifter) - D(shift[axis])) / D(scale[axis]);
      const int number = axis == 0 ? (high ? kWallHighX : kWallLowX) : (high ? kWallHighZ : kWallLowZ);
      set(part == D(number), (*at[axis] - wall) * side, x, y, z);
    }
}

}  // namespace oktett::height
