#include "render/medium/density_noise.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/random.h"

namespace oktett {
namespace {

/// A random number in [0, 1) for a point of the lattice.
double lattice(std::uint64_t key, std::int64_t x, std::int64_t y, std::int64_t z) {
  std::uint64_t bits = key;
  for (const std::int64_t i : {x, y, z})
    bits = mix_bits(bits + kGoldenBits * static_cast<std::uint64_t>(i + 1));
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// Between the corners of a cell the numbers go over into each other with continuous slope and curvature.
double smooth_noise(std::uint64_t key, const Vec3d& p) {
  std::int64_t cell[3];
  double part[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double floor = std::floor(p[axis]), t = p[axis] - floor;
    cell[axis] = static_cast<std::int64_t>(floor);
    part[axis] = t * t * t * (t * (t * 6 - 15) + 10);
  }
  double value = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::int64_t at[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int far = corner >> axis & 1;
      at[axis] = cell[axis] + far;
      weight *= far != 0 ? part[axis] : 1 - part[axis];
    }
    value += weight * lattice(key, at[0], at[1], at[2]);
  }
  return value;
}

}  // namespace

std::shared_ptr<const DensityGrid> density_of(const DensityNoise& noise) {
  const std::uint32_t n = std::clamp(noise.size, 2u, 512u);
  const std::uint32_t octaves = std::clamp(noise.octaves, 1u, 12u);
  Column<float> values(std::size_t{n} * n * n);
  std::size_t i = 0;
  const auto place = [&](std::uint32_t k) { return k / (n - 1.0); };
  for (std::uint32_t z = 0; z < n; ++z)
    for (std::uint32_t y = 0; y < n; ++y)
      for (std::uint32_t x = 0; x < n; ++x) {
        const Vec3d p{place(x), place(y), place(z)};
        double sum = 0, strength = 1, whole = 0, scale = noise.scale;
        for (std::uint32_t octave = 0; octave < octaves; ++octave, strength /= 2, scale *= 2) {
          const std::uint64_t key = mix_bits((std::uint64_t{noise.seed} << 8 | octave) + kGoldenBits);
          sum += strength * smooth_noise(key, p * scale), whole += strength;
        }
        // The part of the way to the faces: 0 in the middle, 1 on a sphere that touches all faces.
        const double out = 2 * length(p - Vec3d{0.5, 0.5, 0.5});
        const double fade = noise.falloff > 0 ? std::clamp((1 - out) / noise.falloff, 0.0, 1.0) : 1;
        const double above = (sum / whole - noise.threshold) / (1 - noise.threshold);
        values[i++] = static_cast<float>(fade * std::clamp(above, 0.0, 1.0));
      }
  return std::make_shared<const DensityGrid>(n, n, n, std::move(values));
}

}  // namespace oktett
