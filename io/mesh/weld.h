#pragma once
/// \file Vertices at the same place. Within io/ only.

#include "core/mesh.h"

namespace oktett {

/// Makes one of all positions that are equal, -0 as 0. The first of each place is kept, in the order of the
/// mesh.
void weld_positions(TriangleMesh& mesh);

}  // namespace oktett
