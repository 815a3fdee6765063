#include "kernels/exact_bounds.h"

#include <cmath>

#include "kernels/exact_shapes.h"

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
  ExactPools pools;
  Box bounds;
  visit_exact(kind_of(shape.form), pools, [&](auto tag, auto& pool) {
    add_exact<decltype(tag)>(pool, shape, to_world, 0);
    for (const ExactCell& cell : pool.cells) {
      const Box b = cell_bounds<decltype(tag)>(pool, cell);
      if (b.empty()) return void(bounds = {});
      bounds.grow(b);
    }
  });
  return bounds;
}

}  // namespace oktett
