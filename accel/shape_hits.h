#pragma once
/// \file Groups of hits whose surfaces are found together: what the code of each instruction set works on.

#include "accel/interaction_block.h"

namespace oktett {

/// `count` hits of one closed-form kind or of one element of an exact kind. Lanes work on groups of eight, so
/// the last hit is repeated to the end of its group.
struct ShapeHits {
  static constexpr std::size_t kMost = InteractionBlock::kMost;

  std::size_t count = 0;
  const float *origin[3], *direction[3];  ///< columns of rays
  const float *t, *part;                  ///< columns of their hits; `part` of an exact shape is Hit::u
  std::uint32_t ray[kMost];               ///< index of each hit in these columns
  std::uint32_t element[kMost];           ///< index in the pool of the kind
  std::uint32_t entry[kMost];             ///< index of each hit in `out`
  InteractionBlock* out;                  ///< receives positions, their errors and normals
  bool with_uv = false;  ///< `out` also receives uv, or `point` what uv follows from: see kHasUvLanes
  /// The points on the surface: of closed forms in the space of the structure, of exact surfaces in their
  /// own.
  double point[3][kMost];
};

}  // namespace oktett
