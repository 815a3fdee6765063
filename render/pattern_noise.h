#pragma once
/// \file The noise of patterns, made from that of core/noise.h.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/noise.h"
#include "core/povray_noise.h"
#include "core/vec3.h"

namespace oktett {

/// gradient_noise in [0, 1], but for the few places where it is slightly more than 1 in size.
inline double unit_noise(const Vec3d& p, NoiseGenerator generator) {
  return generator == NoiseGenerator::own ? 0.5 + 0.5 * gradient_noise(p) : povray_noise(p, generator);
}

/// `noise` twice as steep about the middle, in [0, 1].
inline double steep_noise(double noise) { return std::clamp(0.5 + noise, 0.0, 1.0); }

/// Three places beside p, one for each axis, at which the noises are zero nowhere together on the lattice.
void vector_noise_places(const Vec3d& p, Vec3d (&places)[3]);

/// Writes the noise of `count` places, about from -1 to 1: gradient_noise, in code for this processor, or
/// twice the noise of another generator, less 1.
void noise_at(const Vec3d* places, std::size_t count, NoiseGenerator generator, double* values);

/// Calls place(places), which sets the places of the next octave, for each of `octaves` and then add(noises),
/// with noise_at of these N places, in the same order. The noise of several octaves is computed at once.
template <std::size_t N, class Place, class Add>
void for_each_octave(std::uint32_t octaves, NoiseGenerator generator, const Place& place, const Add& add) {
  constexpr std::uint32_t kAtOnce = 8;
  Vec3d places[kAtOnce][N];
  double noises[kAtOnce][N];
  for (std::uint32_t begin = 0; begin < octaves; begin += kAtOnce) {
    const std::uint32_t count = std::min(kAtOnce, octaves - begin);
    for (std::uint32_t i = 0; i < count; ++i) place(places[i]);
    noise_at(&places[0][0], count * N, generator, &noises[0][0]);
    for (std::uint32_t i = 0; i < count; ++i) add(noises[i]);
  }
}

}  // namespace oktett
