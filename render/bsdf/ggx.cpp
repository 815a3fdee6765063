#include "render/bsdf/ggx.h"

#include <algorithm>

#include "core/math.h"

namespace oktett {

Vec3d ggx_visible_normal(const Vec3d& w, double alpha, const SquareSample& u) {
  const Vec3d stretched = normalize(Vec3d{alpha * w.x, alpha * w.y, w.z});
  const double angle = 2 * std::numbers::pi * u.x;
  // z = 1 - below; the sine from `below`, so that it keeps its digits near the pole.
  const double below = u.y * (1 + stretched.z);
  const double sine = std::sqrt(std::max(0.0, below * (2 - below)));
  const Vec3d halfway =
      Vec3d{sine * portable::cos(angle), sine * portable::sin(angle), 1 - below} + stretched;
  return normalize(Vec3d{alpha * halfway.x, alpha * halfway.y, std::max(0.0, halfway.z)});
}

}  // namespace oktett
