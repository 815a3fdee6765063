#pragma once
/// \file Counts of the steps that rays take through a tree, which its surface-area cost predicts.

#include <cstdint>

#include "accel/accel.h"

namespace oktett {

/// Sums over rays.
struct TraceCounts {
  std::uint64_t rays = 0;
  std::uint64_t nodes = 0;      ///< nodes visited: each tests its eight boxes
  std::uint64_t boxes = 0;      ///< boxes of children that were met
  std::uint64_t blocks = 0;     ///< blocks of triangles tested
  std::uint64_t triangles = 0;  ///< triangles in them
  std::uint64_t other = 0;      ///< other shapes tested
  std::uint64_t instances = 0;  ///< instances entered
  std::uint64_t hits = 0;       ///< rays that hit something
};

/// Finds the nearest hit of each ray by itself, nearest child first, with the scalar code, and counts its
/// steps. Packets and beams visit fewer nodes per ray. What happens inside a Boolean combination is not
/// counted. Uses TBB tasks; the sums do not depend on them.
TraceCounts trace_counts(const Accel& accel, const RaySpan& rays);

}  // namespace oktett
