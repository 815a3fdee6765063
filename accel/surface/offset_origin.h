#pragma once
/// \file offset_origin for those who shade many hits: inline and without branches.

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/box.h"
#include "core/surface_interaction.h"

namespace oktett {

/// `p` + `offset`, rounded away from `p` by one float more. The signs of offsets cannot be foretold.
inline float move_away(float p, float offset) {
  const float sum = p + offset;
  const int direction = (offset > 0) - (offset < 0);
  const auto bits = std::bit_cast<std::int32_t>(sum);
  // Around zero and infinity numbers have other neighbours.
  if (sum == 0 || !std::isfinite(sum)) return offset > 0 ? next_up(sum) : offset < 0 ? next_down(sum) : sum;
  return std::bit_cast<float>(bits + (bits < 0 ? -direction : direction));
}

/// offset_origin(s, direction) of accel/accel.h, written where it is needed: compilers return three floats by
/// way of memory, for which the processor waits.
inline void offset_origin(const SurfaceInteraction& s, const Vec3f& direction, Vec3f& origin) {
  const Vec3f n = s.geometric_normal;
  const float reach = std::abs(n.x) * s.position_error.x + std::abs(n.y) * s.position_error.y +
                      std::abs(n.z) * s.position_error.z;
  const Vec3f offset = n * (dot(direction, n) < 0 ? -reach : reach);
  origin.x = move_away(s.position.x, offset.x);
  origin.y = move_away(s.position.y, offset.y);
  origin.z = move_away(s.position.z, offset.z);
}

}  // namespace oktett
