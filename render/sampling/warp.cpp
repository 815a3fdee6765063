#include "render/sampling/warp.h"

#include <cmath>

#include "core/lane_math.h"

namespace oktett {

Vec3f cosine_direction(const Vec3f& n, const SquareSample& s) {
  using D = Simd<double, 1, ScalarIsa>;
  const double radius = std::sqrt(s.x);
  D sine, cosine;
  sin_cos_of_turn(D(s.y), sine, cosine);
  const auto x = static_cast<float>(radius * only_lane(cosine));
  const auto y = static_cast<float>(radius * only_lane(sine));
  const auto z = static_cast<float>(std::sqrt(1 - s.x));
  Vec3f tangent, bitangent;
  make_basis(n, tangent, bitangent);
  return normalize(tangent * x + bitangent * y + n * z);
}

}  // namespace oktett
