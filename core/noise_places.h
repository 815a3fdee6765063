#pragma once
/// \file Gradient noise (core/noise.h) at several places at once, in code for each instruction set.

#include <cstddef>

#include "core/isa.h"
#include "core/vec3.h"

namespace oktett {

/// Writes gradient_noise of `count` places, the same bits.
using NoiseAtPlaces = void (*)(const Vec3d* places, std::size_t count, double* values);
/// Throws Error if this build holds no code for the set.
NoiseAtPlaces noise_at_places(Isa isa);

}  // namespace oktett
