#pragma once
/// \file The noises of POV-Ray, so that its scenes show the same clouds, grains and veins. The tables are
/// those of POV-Ray 3.7.0.10, measured by asking it (f_noise_generator and vturbulence of its functions.inc).

#include <cstdint>

#include "core/noise_generator.h"
#include "core/vec3.h"

namespace oktett {

/// The noise of a generator of POV-Ray's, in [0, 1]: 1 and 2 are value-gradient noise with periods of 4096,
/// which generator 1 cuts off at both ends and 2 brings into the range, 3 is gradient noise. Not for `own`.
/// NaN or any number in [0, 1] if a coordinate is not finite or larger than 2^31 in size.
double povray_noise(const Vec3d& p, NoiseGenerator generator);

/// Three value-gradient noises of other slopes, about from -0.6 to 0.6, as POV-Ray's turbulence has them.
Vec3d povray_noise_vector(const Vec3d& p);

/// Random numbers in [0, 1) of a cell of the integer lattice: `which` 0 for cells, all three for the point of
/// crackle in a cell.
double povray_cell_number(std::int64_t x, std::int64_t y, std::int64_t z, int which);

/// One of the waves of `ripples` and `waves`.
struct PovrayWave {
  Vec3d source;  ///< of unit length
  double frequency;
};
PovrayWave povray_wave(std::uint32_t number);

}  // namespace oktett
