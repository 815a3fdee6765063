#pragma once
/// \file Hits of closed-form and exact shapes in columns, and their surfaces: what the code of each
/// instruction set works on.

#include "accel/interaction_block.h"

namespace oktett {

/// `count` hits of one closed-form kind or of one element of an exact kind. Lanes work on groups of eight, so
/// the entries from the last hit to the end of its group must hold any numbers and elements that exist.
struct ShapeHits {
  static constexpr std::size_t kMost = InteractionBlock::kMost;

  std::size_t count = 0;
  float origin[3][kMost], direction[3][kMost], t[kMost];
  float part[kMost];             ///< Hit::u: the part of an exact shape that was hit
  std::uint32_t element[kMost];  ///< index in the pool of the kind

  /// The results, as in SurfaceInteraction. `normal` is both geometric and shading normal.
  float position[3][kMost], position_error[3][kMost], normal[3][kMost];
};

}  // namespace oktett
