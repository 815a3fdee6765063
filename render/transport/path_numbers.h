#pragma once
/// \file Numbers that path tracing with single hits and in lanes share.

#include "core/platform.h"

namespace oktett {

/// Bounces before Russian roulette begins. From then on a path goes on with the square root of its throughput
/// as probability: the noise of bounces grows less than the time falls. The root, as short paths bring most
/// of the noise, and long ones most of the time. At mirrors and clear glass what they alone leave of the
/// light takes the place of the throughput: a path through clear glass to a lamp brings much light, and no
/// light sample replaces it.
inline constexpr unsigned kSureBounces = 2;

/// tmax of a shadow ray over the vector to a point on a light: it ends before the light's surface, whose
/// place is known to a few units in the last place of its coordinates only. It is 1 less the larger of
/// kLeastGap and of kPlaceError times the greatest coordinate over the distance, but no more than half.
inline constexpr float kPlaceError = 0x1p-20f, kLeastGap = 0x1p-13f;

}  // namespace oktett
