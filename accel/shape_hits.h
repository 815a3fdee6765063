#pragma once
/// \file Hits of closed-form and exact shapes on their way to surfaces: columns that the code of each
/// instruction set works on.

#include "accel/interaction_block.h"

namespace oktett {

/// `count` hits of one kind of shape; of exact shapes, of one element. Columns are read in groups of eight;
/// what follows the last hit must be numbers, any numbers, and element numbers that exist.
struct ShapeHits {
  static constexpr std::size_t kMost = InteractionBlock::kMost;

  std::size_t count = 0;
  float origin[3][kMost], direction[3][kMost], t[kMost];
  float part[kMost];             ///< Hit::u, of exact shapes the part that was met
  std::uint32_t element[kMost];  ///< in its pool

  /// What SurfaceInteraction has of these names.
  float position[3][kMost], position_error[3][kMost], normal[3][kMost];
};

}  // namespace oktett
