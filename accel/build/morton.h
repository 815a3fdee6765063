#pragma once
/// \file References in the order of a space-filling curve, for the fast build.

#include "accel/build/build_arrays.h"

namespace oktett {

/// Bits of a cell's number: seven per axis, interleaved (Morton 1966).
inline constexpr int kMortonBits = 21;

/// Copies the references to arrays.more_refs in the order of the cells that their centres lie in, of a
/// cubic grid over `centers`, and sets arrays.cells. References of one cell keep their order.
void sort_by_cells(const BuildArrays& arrays, const Centers& centers, bool parallel);

}  // namespace oktett
