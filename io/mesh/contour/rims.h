#pragma once
/// \file Where a surface ends or turns back within a face of a grid. Within io/ only.

#include <cstdint>
#include <utility>
#include <vector>

#include "io/mesh/contour/grid.h"
#include "io/mesh/contour/links.h"

namespace oktett {

/// A point of a rim, which lies in a face of the grid.
struct RimPoint {
  SlotNumber slot = kNoId;  ///< from whose crossing it was found
  Vec3d position;
  Vec3f normal;
};

/// The points, in ascending order of their slots, where the curve that begins at a slot without a link ends;
/// or, if the link leads to the same edge of the grid, where it turns, as at the edge of a thin plate. Found
/// by bisection with rays along the edge that start ever farther from it. Where the surface is too steep for
/// that there is none.
std::vector<RimPoint> find_rims(const Accel& accel, const ContourGrid& grid,
                                const ContourCrossings& crossings, const std::vector<SlotNumber>& links);

/// That of a slot, or null.
const RimPoint* find_rim(const std::vector<RimPoint>& rims, SlotNumber slot);

}  // namespace oktett
