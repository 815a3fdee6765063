#pragma once
/// \file The noise of patterns: random numbers of the integer lattice, and Perlin's noise between them.

#include <cmath>
#include <cstdint>

#include "core/vec3.h"

namespace oktett {

/// What `x` is above the integer below it.
inline double fraction_of(double x) { return x - std::floor(x); }

/// The integer below `x` as a number for hashing; 0 where it does not fit.
std::int64_t cell_of(double x);

/// Random bits of a point of the integer lattice.
std::uint64_t lattice_bits(std::int64_t x, std::int64_t y, std::int64_t z);

/// 53 of the bits as a number in [0, 1).
inline double unit_of(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

/// Gradient noise after Perlin (2002) in [-1, 1]; 0 at the points of the integer lattice.
double gradient_noise(const Vec3d& p);

/// The same in [0, 1].
inline double unit_noise(const Vec3d& p) { return 0.5 + 0.5 * gradient_noise(p); }

/// Three noises, one for each axis, which are zero nowhere together on the lattice.
Vec3d vector_noise(const Vec3d& p);

/// Twice as steep about the middle, in [0, 1].
double steep_noise(const Vec3d& p);

}  // namespace oktett
