#pragma once
/// \file Which nodes of a grid are inside of a solid. Within io/ only.

#include "io/mesh/contour/grid.h"

namespace oktett {

/// Makes the crossings of the surface of a solid agree with each other: along each line they enter and leave
/// in turn, and on the edges around each face of the grid their number is even. Which nodes are inside is
/// what the lines along x say; where rounding lets another line say otherwise, a crossing moves past the
/// node. Normals point outwards then.
void make_consistent(const ContourGrid& grid, ContourCrossings& crossings);

}  // namespace oktett
