#pragma once
/// \file Hits that are shaded together, in columns: what the code of each instruction set works on.

#include <cstdint>

#include "accel/interaction_block.h"

namespace oktett {

/// Beside the hits' InteractionBlock: their rays, and one light as the hits see it. Lanes read and write
/// whole groups of eight, so the entries between the last hit and the end of its group must hold numbers,
/// whatever their values; zeros are fast.
struct ShadingColumns {
  static constexpr std::size_t kMost = InteractionBlock::kMost;

  std::size_t count = 0;
  float direction[3][kMost];     ///< unit direction in which the ray travels
  std::int32_t exponent[kMost];  ///< to which the highlight is raised, 0 if not by squaring
  std::int32_t greatest_exponent = 0;
  float ng[3][kMost], ns[3][kMost];  ///< as in ShadingPoint

  float origin[3][kMost];  ///< of the ray to the light
  float falloff[kMost];    ///< 1 / squared distance; not set for directional lights
  float cosine[kMost];     ///< between ns and the light; 0 where the light is behind
  float highlight[kMost];  ///< cosine between the mirrored light and the viewer
  float power[kMost];      ///< highlight^exponent, where highlight is not above 1
};

}  // namespace oktett
