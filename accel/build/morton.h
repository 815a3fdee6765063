#pragma once
/// \file References in the order of a space-filling curve, for the fast build.

#include "accel/build/sah.h"
#include "core/soa.h"

namespace oktett {

/// Bits of a cell's number: seven per axis, interleaved (Morton 1966).
inline constexpr int kMortonBits = 21;

/// Copies `refs` to `sorted` in the order of the cells that their centres lie in, of a cubic grid over
/// `centers`, and sets `cells`. References of one cell keep their order.
void sort_by_cells(const Column<PrimRef>& refs, const Centers& centers, bool parallel,
                   Column<PrimRef>& sorted, Column<std::uint32_t>& cells);

}  // namespace oktett
