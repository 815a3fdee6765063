#include "render/bsdf/ggx.h"

#include <algorithm>

#include "core/math.h"

namespace oktett {

/// The normal at the point (u.x: azimuth, u.y: height) of the cap from the pole down to z = -bound.
static Vec3d normal_of_cap(const Vec3d& w, double alpha, double bound, const SquareSample& u) {
  const Vec3d stretched = normalize(Vec3d{alpha * w.x, alpha * w.y, w.z});
  const double angle = 2 * std::numbers::pi * u.x;
  // z = 1 - below; the sine from `below`, so that it keeps its digits near the pole.
  const double below = u.y * (1 + bound * stretched.z);
  const double sine = std::sqrt(std::max(0.0, below * (2 - below)));
  const Vec3d halfway =
      Vec3d{sine * portable::cos(angle), sine * portable::sin(angle), 1 - below} + stretched;
  return normalize(Vec3d{alpha * halfway.x, alpha * halfway.y, std::max(0.0, halfway.z)});
}

Vec3d ggx_visible_normal(const Vec3d& w, double alpha, const SquareSample& u) {
  return normal_of_cap(w, alpha, 1, u);
}

/// How far down the cap goes of which facets may reflect above the surface, relative to the whole visible
/// cap.
static double reflecting_bound(const Vec3d& w, double alpha) {
  const double s = 1 + std::sqrt(w.x * w.x + w.y * w.y), s2 = s * s, a2 = alpha * alpha;
  return (1 - a2) * s2 / (s2 + a2 * w.z * w.z);
}

Vec3d ggx_reflecting_normal(const Vec3d& w, double alpha, const SquareSample& u) {
  return normal_of_cap(w, alpha, reflecting_bound(w, alpha), u);
}

double ggx_reflected_scale(const Vec3d& w, double alpha) {
  const double size = length(Vec3d{alpha * w.x, alpha * w.y, w.z});
  return 1 / (2 * (reflecting_bound(w, alpha) * w.z + size));
}

}  // namespace oktett
