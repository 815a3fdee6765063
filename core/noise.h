#pragma once
/// \file Perlin's noise: random slopes at the points of the integer lattice, and a smooth function between
/// them that has them; its derivatives, and enclosures of both over boxes. The same for POV-Ray's noise,
/// whose tables are those of core/povray_noise.h.
///
/// The code is compiled once, for no instruction set in particular, so that all that call it get the same
/// bits.

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

/// Gradient noise (K. Perlin: Improving noise, 2002), with slopes that `lattice_bits` chooses; 0 at the
/// points of the integer lattice. It has continuous second derivatives. NaN if a coordinate is not finite.
double gradient_noise(const Vec3d& p);

/// The noises that functions can have: gradient_noise, and the value-gradient noise behind POV-Ray's
/// generators 1 and 2, about from -1.05 to 1, whose second derivatives jump at the faces of cells.
enum class NoiseKind : std::uint8_t { gradient, povray };

/// Bounds on the magnitude of a noise, of its derivative by x, y or z, of its second derivative twice by one
/// of them, and of that by two of them, whatever stands at the points of the lattice.
struct NoiseBounds {
  double value, slope, bend, twist;
};
constexpr NoiseBounds bounds_of(NoiseKind kind) {
  return kind == NoiseKind::gradient ? NoiseBounds{1.06, 3.85, 12.4, 11.2} : NoiseBounds{2.1, 7.1, 30, 26};
}
/// Bounds on the absolute rounding errors of its value and its derivatives.
inline constexpr double kNoiseError = 0x1p-43, kNoiseSlopeError = 0x1p-41;

/// A noise. Of `gradient` the same bits as of gradient_noise. NaN if a coordinate is not finite.
double noise_value(const Vec3d& p, NoiseKind kind);

/// The noise, the same bits as of noise_value, and its derivatives by x, y and z.
struct NoiseSlope {
  double value;
  Vec3d gradient;
};
NoiseSlope noise_slope(const Vec3d& p, NoiseKind kind = NoiseKind::gradient);

/// Enclosures of the noise and of its derivatives by x, y and z over the box from `lo` to `hi`, wider than
/// rounding errors: over a point the noise's is 2 kNoiseError wide, and over a small box by no more than the
/// bounds on the derivatives allow. Where the box meets more than eight cells of the lattice, or has a corner
/// that is not finite, they are the bounds above.
struct NoiseRange {
  double lo, hi;
  Vec3d slope_lo, slope_hi;
};
NoiseRange noise_range(const Vec3d& lo, const Vec3d& hi, NoiseKind kind = NoiseKind::gradient);

}  // namespace oktett
