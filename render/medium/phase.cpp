#include "render/medium/phase.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"
#include "render/medium/medium.h"

namespace oktett {

/// `anisotropy` within its bounds; 0 for NaN.
static double bounded(float anisotropy) {
  const double most = kMostAnisotropy;
  return anisotropy == anisotropy ? std::clamp(static_cast<double>(anisotropy), -most, most) : 0;
}

float phase_value(const Vec3f& direction, const Vec3f& onward, float anisotropy) {
  const double g = bounded(anisotropy);
  const Vec3d a(direction), b(onward);
  // The cosine would lose the smallest angles: |a - b|^2 = 2 - 2 cos, |a + b|^2 = 2 + 2 cos.
  const double square =
      g < 0 ? (1 + g) * (1 + g) - g * dot(a + b, a + b) : (1 - g) * (1 - g) + g * dot(a - b, a - b);
  return static_cast<float>((1 - g * g) / (4 * std::numbers::pi * square * std::sqrt(square)));
}

Vec3f phase_direction(const Vec3f& direction, float anisotropy, const SquareSample& u) {
  const double g = bounded(anisotropy);
  double cosine = 1 - 2 * u.x;
  if (std::abs(g) > 1e-3) {
    const double root = (1 - g * g) / (1 + g - 2 * g * u.x);
    cosine = std::clamp((1 + g * g - root * root) / (2 * g), -1.0, 1.0);
  }
  const double sine = std::sqrt((1 - cosine) * (1 + cosine)), angle = 2 * std::numbers::pi * u.y;
  const Vec3d z = normalize(Vec3d(direction));
  Vec3d x, y;
  make_basis(z, x, y);
  return Vec3f(normalize(x * (sine * portable::cos(angle)) + y * (sine * portable::sin(angle)) + z * cosine));
}

}  // namespace oktett
