#pragma once
/// \file Numbers that path tracing with single hits and in lanes share.

#include "core/platform.h"

namespace oktett {

/// Bounces before Russian roulette begins.
inline constexpr unsigned kSureBounces = 3;
inline constexpr float kMostSurvival = 0.95f;

/// tmax of a shadow ray over the vector to a point on a light: it ends before the light's surface, whose
/// place is known to a few units in the last place of its coordinates only. It is 1 less the larger of
/// kLeastGap and of kPlaceError times the greatest coordinate over the distance, but no more than half.
inline constexpr float kPlaceError = 0x1p-20f, kLeastGap = 0x1p-13f;

}  // namespace oktett
