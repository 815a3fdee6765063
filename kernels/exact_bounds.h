#pragma once
/// \file Bounds of exact surfaces in the world.

#include "core/box.h"
#include "kernels/shapes/exact.h"

namespace oktett {

/// The image of a cell under the map from its element's own space, rounded outwards; empty if the cell is
/// not bounded.
Box cell_bounds(const Affine& to_world, const ExactCell& cell);

/// Bounds of `shape`; empty if it is degenerate or not bounded.
Box exact_bounds(const ExactShape& shape, const Affine& to_world);

}  // namespace oktett
