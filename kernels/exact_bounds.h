#pragma once
/// \file Bounds of exact surfaces in the world.

#include "core/box.h"
#include "kernels/exact/exact.h"
#include "kernels/exact_form.h"

namespace oktett {

/// The image of a cell under the map from its element's own space, rounded outwards; empty if the cell is
/// not bounded.
Box cell_bounds(const Affine& to_world, const ExactCell& cell);

/// Bounds of a cell of shape S in the world.
template <class S>
Box cell_bounds(const typename S::Pool& pool, const ExactCell& cell) {
  if constexpr (requires { S::world_bounds(pool, std::size_t{0}); })
    return S::world_bounds(pool, cell.element);
  else
    return cell_bounds(pool.frames[cell.element].to_world, cell);
}

/// Bounds of `shape`; empty if it is degenerate or not bounded.
Box exact_bounds(const ExactShape& shape, const Affine& to_world);

}  // namespace oktett
