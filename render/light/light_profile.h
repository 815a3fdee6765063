#pragma once
/// \file The intensity of a small emitter by direction, as its maker measures it.

#include <vector>

#include "core/vec3.h"

namespace oktett {

/// A table of intensities. Vertical angles count in degrees from the emitter's axis, which usually points
/// down, horizontal ones about it.
struct LightProfile {
  std::vector<double> vertical;    ///< ascending, within [0, 180]; beyond them it is dark
  std::vector<double> horizontal;  ///< ascending from 0 to 360, or 0 alone: the same all around
  /// values[h * vertical.size() + v], >= 0, relative to the greatest of them, which is 1. Interpolated
  /// linearly in both angles.
  std::vector<float> values;
};

/// The value for angles in degrees: `vertical` within [0, 180], `horizontal` within [0, 360].
double profile_value(const LightProfile& profile, double vertical, double horizontal);

/// The integral of the values over all directions: the power in W of an emitter of greatest intensity 1 W/sr.
double profile_flux(const LightProfile& profile);

}  // namespace oktett
