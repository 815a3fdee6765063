#include "render/sampling/warp.h"

#include <cmath>
#include <numbers>

#include "core/elementary.h"
#include "core/math.h"

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

SquareSample disk_point(const SquareSample& s) {
  constexpr double kQuarter = std::numbers::pi / 4;
  const double a = 2 * s.x - 1, b = 2 * s.y - 1;
  if (a == 0 && b == 0) return {0, 0};
  const bool wide = std::abs(a) > std::abs(b);
  const double radius = wide ? a : b, angle = kQuarter * (wide ? b / a : a / b);
  const double along = radius * portable::cos(angle), across = radius * portable::sin(angle);
  return wide ? SquareSample{along, across} : SquareSample{across, along};
}

}  // namespace oktett
