#include "kernels/exact_bounds.h"

#include <cmath>

namespace oktett {

Box cell_bounds(const Affine& to_world, const ExactCell& cell) {
  Box b;
  for (int k = 0; k < 3; ++k)
    if (!std::isfinite(cell.lo[k]) || !std::isfinite(cell.hi[k])) return b;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3d p;
    for (int k = 0; k < 3; ++k) p[k] = (corner >> k & 1) != 0 ? cell.hi[k] : cell.lo[k];
    const Vec3d q = to_world.point(p);
    // Taking a ray into the own space may displace it by a few roundings of the coordinates.
    const double pad = 0x1p-45 * (length(q) + length(to_world.vector(p)));
    b.grow(Box{round_down(q - Vec3d{pad, pad, pad}), round_up(q + Vec3d{pad, pad, pad})});
  }
  return b;
}

Box exact_bounds(const ExactShape& shape, const Affine& to_world) {
  Box bounds;
  bool bounded = true;
  each_cell_bounds(shape, to_world, [&](const Box& b) {
    bounded &= !b.empty();
    bounds.grow(b);
  });
  return bounded ? bounds : Box{};
}

bool is_unbounded(const ExactShape& shape, const Affine& to_world) {
  bool unbounded = false;
  each_cell_bounds(shape, to_world, [&](const Box& b) { unbounded |= b.empty(); });
  return unbounded;
}

}  // namespace oktett
