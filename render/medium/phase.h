#pragma once
/// \file How a medium scatters light: the phase function of Henyey and Greenstein (1941). Directions have
/// unit length.

#include "core/vec3.h"
#include "render/sampling/square_sample.h"

namespace oktett {

/// Density per solid angle of scattering from `direction`, in which light or a path travels, into `onward`.
/// It is also the value of the phase function. `anisotropy` is clamped to kMostAnisotropy.
float phase_value(const Vec3f& direction, const Vec3f& onward, float anisotropy);

/// A direction of that density.
Vec3f phase_direction(const Vec3f& direction, float anisotropy, const SquareSample& u);

}  // namespace oktett
