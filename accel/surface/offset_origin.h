#pragma once
/// \file offset_origin in lanes, and inline for single rays.

#include "core/lanes.h"
#include "core/simd.h"
#include "core/surface_interaction.h"

namespace oktett {

/// Origins for rays that leave surfaces towards `direction`: moved along the geometric normal `n` by the
/// error bound of the position, and rounded away from the position by one more float. See offset_origin in
/// accel/accel.h.
template <class F>
OKTETT_INLINE Vec3<F> offset_lanes(const Vec3<F>& position, const Vec3<F>& error, const Vec3<F>& n,
                                   const Vec3<F>& direction) {
  const F reach = abs(n.x) * error.x + abs(n.y) * error.y + abs(n.z) * error.z;
  const Vec3<F> offset = scale_lanes(n, select(dot_lanes(direction, n) < F(0.0f), -reach, reach));
  return {next_float(position.x + offset.x, offset.x), next_float(position.y + offset.y, offset.y),
          next_float(position.z + offset.z, offset.z)};
}

/// offset_origin(s, direction) of accel/accel.h for callers in hot loops. It writes to `origin` because
/// compilers return three floats through memory, and reading them back at once stalls the processor.
inline void offset_origin(const SurfaceInteraction& s, const Vec3f& direction, Vec3f& origin) {
  using F = Simd<float, 1, ScalarIsa>;
  const Vec3<F> moved = offset_lanes(broadcast<F>(s.position), broadcast<F>(s.position_error),
                                     broadcast<F>(s.geometric_normal), broadcast<F>(direction));
  origin.x = moved.x.part[0].v, origin.y = moved.y.part[0].v, origin.z = moved.z.part[0].v;
}

}  // namespace oktett
