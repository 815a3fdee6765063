#pragma once
/// \file How the crossings around each face of a grid belong together. Within io/ only.

#include <cstdint>
#include <utility>
#include <vector>

#include "io/mesh/contour/grid.h"

namespace oktett {

/// Each crossing lies on an edge around which there are four faces of the grid and four cells. With b and c
/// the axes after that of the edge, *slot* 0 is the face along c that begins at the edge, 1 the one that ends
/// there, 2 and 3 are those along b. *Quadrant* 2 i + j is the cell that begins (i = 0) or ends (i = 1) at
/// the edge along b, and along c by j. A face cuts the surface in curves; a *link* is one of them, from one
/// crossing to another.
inline constexpr std::uint32_t kSlots = 4;

/// The slot of crossing x in a face is 4 x + slot.
using SlotNumber = std::uint32_t;

/// The quadrant, as 4 x + quadrant, of the crossing of a slot in the cell that begins at its face (`side` 0)
/// or ends there (1).
inline std::uint32_t quadrant_at(SlotNumber slot, std::uint32_t side) {
  const std::uint32_t x = slot / kSlots, s = slot % kSlots;
  return kSlots * x + (s < 2 ? 2 * side + s : 2 * (s - 2) + side);
}

/// The slots of the crossing of a quadrant in the two faces of the cell that meet at its edge.
inline std::pair<SlotNumber, SlotNumber> slots_of(std::uint32_t quadrant) {
  const std::uint32_t x = quadrant / kSlots, q = quadrant % kSlots;
  return {kSlots * x + q % 2, kSlots * x + 2 + q / 2};
}

/// For each slot that to which a link leads, or kNoId. Links of a face do not cross, and the surface is on
/// the same side all along. Of several ways to link, that with the least angles between the links and the
/// surface at their ends is taken. `closed`: the number of crossings around each face is even, and all are
/// linked; else some may stay alone, where the surface ends.
std::vector<SlotNumber> link_crossings(const ContourGrid& grid, const ContourCrossings& crossings,
                                       bool closed);

}  // namespace oktett
