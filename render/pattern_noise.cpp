#include "render/pattern_noise.h"

#include <algorithm>
#include <cmath>

#include "core/random.h"

namespace oktett {

std::int64_t cell_of(double x) { return std::abs(x) < 0x1p62 ? static_cast<std::int64_t>(std::floor(x)) : 0; }

std::uint64_t lattice_bits(std::int64_t x, std::int64_t y, std::int64_t z) {
  std::uint64_t bits = mix_bits(static_cast<std::uint64_t>(x) + kGoldenBits);
  bits = mix_bits(bits + static_cast<std::uint64_t>(y) + kGoldenBits);
  return mix_bits(bits + static_cast<std::uint64_t>(z) + kGoldenBits);
}

namespace {

/// The scalar product of `d` with the gradient of a lattice point: one of the twelve vectors to the middles
/// of the edges of a cube.
double edge_product(std::uint64_t bits, const Vec3d& d) {
  const double a = bits & 1 ? -1 : 1, b = bits & 2 ? -1 : 1;
  switch ((bits >> 32) % 3) {
    case 0:
      return a * d.x + b * d.y;
    case 1:
      return a * d.y + b * d.z;
    default:
      return a * d.z + b * d.x;
  }
}

/// 0 at 0 and 1 at 1, with first and second derivatives of 0 there.
double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

double mix(double a, double b, double t) { return a + (b - a) * t; }

}  // namespace

double gradient_noise(const Vec3d& p) {
  const std::int64_t x = cell_of(p.x), y = cell_of(p.y), z = cell_of(p.z);
  const Vec3d f{p.x - std::floor(p.x), p.y - std::floor(p.y), p.z - std::floor(p.z)};
  double corner[8];
  for (int i = 0; i < 8; ++i) {
    const int dx = i & 1, dy = i >> 1 & 1, dz = i >> 2;
    corner[i] = edge_product(lattice_bits(x + dx, y + dy, z + dz), f - Vec3d{1.0 * dx, 1.0 * dy, 1.0 * dz});
  }
  const double u = fade(f.x), v = fade(f.y), w = fade(f.z);
  const double low = mix(mix(corner[0], corner[1], u), mix(corner[2], corner[3], u), v);
  const double high = mix(mix(corner[4], corner[5], u), mix(corner[6], corner[7], u), v);
  return mix(low, high, w);
}

Vec3d vector_noise(const Vec3d& p) {
  // Far from each other, and beside the lattice by different parts.
  return {gradient_noise(p + Vec3d{0.37, 0.71, 0.23}), gradient_noise(p + Vec3d{57.61, 13.19, 91.43}),
          gradient_noise(p + Vec3d{-31.29, 77.53, -43.83})};
}

double steep_noise(const Vec3d& p) { return std::clamp(0.5 + gradient_noise(p), 0.0, 1.0); }

}  // namespace oktett
