#pragma once
/// \file Leaves of triangles that share a block of corners.

#include "accel/accel_data.h"

namespace oktett {

/// The two leaves `a` and `b`, of plain blocks, in one packed block with the same corners, bit by bit.
/// Returns false, and then `out` has any value, if they have too many corners, or if these lie too far apart.
bool pack_leaves(const TriangleBlock& a, const TriangleBlock& b, TriangleBlock& out);

/// Packs leaves of a tree whose blocks are all plain two by two where that is possible. The rest of the
/// memory is given back. The same tree for any number of threads.
void compact_blocks(Accel& accel, bool parallel);

}  // namespace oktett
