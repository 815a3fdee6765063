#pragma once
/// \file How much work rays make in a tree: what the surface-area cost predicts, counted.

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

/// Walks every ray by itself to its nearest hit, nearest child first, and counts. A walk of its own, in plain
/// code, so that the queries carry no counters; packets visit fewer nodes per ray. Uses TBB tasks; the sums
/// do not depend on them.
TraceCounts trace_counts(const Accel& accel, const RaySpan& rays);

}  // namespace oktett
