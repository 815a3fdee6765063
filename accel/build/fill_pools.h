#pragma once
/// \file The pools, laid out in the order in which the leaves refer to them.

#include "accel/build/wide_tree.h"

namespace oktett {

/// Fills the pools of `accel`, its instances and combinations, and numbers the paths through them. Cells of
/// exact surfaces, listed instances and combinations are there already and are brought into order.
/// Moves the leaves of spheres to multiples of eight, in `order` too.
void fill_pools(Accel& accel, ItemOrder& order);

}  // namespace oktett
