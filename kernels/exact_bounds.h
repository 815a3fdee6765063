#pragma once
/// \file Bounds of exact surfaces in the world.

#include "core/box.h"
#include "kernels/exact_ops.h"

namespace oktett {

/// The image of a cell under the map from its element's own space, rounded outwards; empty if the cell is
/// not bounded.
Box cell_bounds(const Affine& to_world, const ExactCell& cell);

/// Calls f(bounds) for each cell of `shape`; empty bounds are those of a cell that is not bounded.
template <class Function>
void each_cell_bounds(const ExactShape& shape, const Affine& to_world, Function&& f) {
  const ExactOps& ops = exact_ops(kind_of(shape.form));
  const auto pool = ops.make_pool();
  ops.add(*pool, shape, to_world, 0);
  for (const ExactCell& cell : pool->cells) f(ops.cell_bounds(*pool, cell));
}

/// Bounds of `shape`; empty if it is degenerate or not bounded.
Box exact_bounds(const ExactShape& shape, const Affine& to_world);
bool is_unbounded(const ExactShape& shape, const Affine& to_world);

}  // namespace oktett
