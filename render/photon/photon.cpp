#include "render/photon/photon.h"

#include <algorithm>
#include <cmath>

namespace oktett {

static double sign_of(double x) { return x < 0 ? -1 : 1; }

static std::uint32_t to_bits(double x) {
  return static_cast<std::uint32_t>(std::clamp(x * 32767 + 32768.5, 1.0, 65535.0));
}

static double from_bits(std::uint32_t bits) { return (std::max(bits, 1u) - 32768.0) / 32767; }

std::uint32_t pack_direction(const Vec3f& direction) {
  const Vec3d d(direction);
  const double sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  double x = d.x / sum, y = d.y / sum;
  if (d.z < 0) {
    const double folded = (1 - std::abs(y)) * sign_of(x);
    y = (1 - std::abs(x)) * sign_of(y), x = folded;
  }
  return to_bits(x) << 16 | to_bits(y);
}

Vec3f unpack_direction(std::uint32_t packed) {
  const double x = from_bits(packed >> 16), y = from_bits(packed & 0xffff);
  const double z = 1 - std::abs(x) - std::abs(y);
  if (z >= 0) return Vec3f(normalize(Vec3d{x, y, z}));
  return Vec3f(normalize(Vec3d{(1 - std::abs(y)) * sign_of(x), (1 - std::abs(x)) * sign_of(y), z}));
}

}  // namespace oktett
