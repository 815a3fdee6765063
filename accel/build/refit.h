#pragma once
/// \file Trees whose vertices move and whose links stay.

#include "accel/accel_data.h"

namespace oktett {

/// Whether `accel` can be refitted: it holds one mesh, which no transform moves and none of whose triangles
/// was split.
bool can_refit(const Accel& accel);

/// Fits the tree to the positions that the mesh has now, which differ from those that it was built of:
/// corners of triangles, boxes, bounds and the stats. can_refit(accel) must be true. Returns false, and then
/// the structure must not be used any more, if the tree cannot hold these triangles: one is not finite, or
/// was not when the tree was built, or corners of a block that lay at one place are too many apart.
bool refit(Accel& accel, bool parallel);

/// The same tree in memory of its own. can_refit(accel) must be true.
std::shared_ptr<Accel> clone_tree(const Accel& accel);

}  // namespace oktett
