#include "render/sampling/warp.h"

#include <cmath>
#include <numbers>

#include "core/math.h"

namespace oktett {

Vec3f cosine_direction(const Vec3f& n, const SquareSample& s) {
  const double radius = std::sqrt(s.x), angle = 2 * std::numbers::pi * s.y;
  const auto x = static_cast<float>(radius * portable::cos(angle));
  const auto y = static_cast<float>(radius * portable::sin(angle));
  const auto z = static_cast<float>(std::sqrt(1 - s.x));
  Vec3f tangent, bitangent;
  make_basis(n, tangent, bitangent);
  return normalize(tangent * x + bitangent * y + n * z);
}

}  // namespace oktett
