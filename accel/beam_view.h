#pragma once
/// \file The part of a beam (accel/traverse/beam/beam_rays.h) that the code of a surface reads.

#include <cstdint>

#include "core/vec3.h"

namespace oktett {

inline constexpr int kBeamRays = 256;
inline constexpr int kBeamGroup = 16;  ///< rays that are tested against a triangle or a shape together
inline constexpr int kBeamGroups = kBeamRays / kBeamGroup;

/// The columns and the frame of a beam; see the members of BeamRays of the same names.
struct BeamView {
  const float *x, *y, *hit_lo, *hit_hi;
  Vec3d apex;  ///< in the scene
  int axis[3];
  bool mirrored;
  float farthest;  ///< greatest |x| and |y|
  float slack;     ///< bounds the distance of a ray from the line that (x, y) stands for
  float near_s;
  bool any;  ///< any hit will do, and the rays end at the apex
};

/// For each group of a beam, the rays that a shape may concern, a bit each.
struct BeamLanes {
  std::uint16_t maybe[kBeamGroups];  ///< in: the rays to be tested; out: those that may hit the shape
  std::uint16_t sure[kBeamGroups];   ///< out: those of them that surely hit it before the end of their range
  std::uint16_t leave[kBeamGroups];  ///< out: those that miss it if they start outside (ExactCode::outside)
};

}  // namespace oktett
