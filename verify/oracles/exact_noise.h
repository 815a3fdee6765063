#pragma once
/// \file The noises of core/noise.h in extended precision, by their definition: the sum over the corners of a
/// cell of the product of a random vector with the way from the corner, and of POV-Ray's a value, times the
/// weights of the corner along the axes.

#include <cmath>

#include "core/noise.h"
#include "core/povray_lattice.h"

namespace oktett {

inline long double exact_noise(long double x, long double y, long double z) {
  const long double p[3] = {x, y, z};
  long double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    long double way[3], weight = 1;
    std::int64_t at[3];
    for (int k = 0; k < 3; ++k) {
      const int side = corner >> k & 1;
      at[k] = static_cast<std::int64_t>(std::floor(p[k])) + side;
      way[k] = p[k] - static_cast<long double>(at[k]);
      // 1 at the corner and 0 one cell further: 1 - 10 t^3 + 15 t^4 - 6 t^5.
      const long double t = std::abs(way[k]);
      weight *= 1 - 10 * t * t * t + 15 * t * t * t * t - 6 * t * t * t * t * t;
    }
    const std::uint64_t bits = lattice_bits(at[0], at[1], at[2]);
    const int first = static_cast<int>((bits >> 32) % 3), second = (first + 1) % 3;
    const long double along = (bits & 1 ? -way[first] : way[first]) + (bits & 2 ? -way[second] : way[second]);
    sum += weight * along;
  }
  return sum;
}

inline long double exact_povray_noise(long double x, long double y, long double z) {
  const long double p[3] = {x, y, z};
  std::int64_t cell[3];
  for (int k = 0; k < 3; ++k) cell[k] = static_cast<std::int64_t>(std::floor(p[k]));
  const double* corners[8];
  povray_corners(cell[0], cell[1], cell[2], corners);
  long double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    long double weight = 1, own = corners[corner][0];
    for (int k = 0; k < 3; ++k) {
      const long double way = p[k] - static_cast<long double>(cell[k] + (corner >> k & 1)), t = std::abs(way);
      weight *= 1 - 3 * t * t + 2 * t * t * t;
      own += corners[corner][1 + k] * way;
    }
    sum += weight * own;
  }
  return sum;
}

inline long double exact_noise(const Vec3<long double>& p, NoiseKind kind) {
  return kind == NoiseKind::gradient ? exact_noise(p.x, p.y, p.z) : exact_povray_noise(p.x, p.y, p.z);
}

}  // namespace oktett
