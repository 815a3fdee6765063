#pragma once
/// \file The noise of patterns, made from that of core/noise.h.

#include "core/noise.h"
#include "core/vec3.h"

namespace oktett {

/// gradient_noise in [0, 1], but for the few places where it is slightly more than 1 in size.
inline double unit_noise(const Vec3d& p) { return 0.5 + 0.5 * gradient_noise(p); }

/// Three noises, one for each axis, which are zero nowhere together on the lattice.
Vec3d vector_noise(const Vec3d& p);

/// Twice as steep about the middle, in [0, 1].
double steep_noise(const Vec3d& p);

}  // namespace oktett
