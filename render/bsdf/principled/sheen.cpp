#include "render/bsdf/principled/sheen.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math.h"
#include "render/sampling/warp.h"

namespace oktett {

SheenFibres::SheenFibres(const Vec3d& wo, double roughness) {
  const double x = std::clamp(wo.z, 0.0, 1.0), y = std::clamp(roughness, 0.01, 1.0);
  const double width = y * (0.0206607 + 1.58491 * y) / (0.0379424 + y * (1.32227 + y));
  const double mean = y * (-0.193854 + y * (-1.14885 + y * (1.7932 - 0.95943 * y * y))) / (0.046391 + y);
  const double rest = y * (0.000654023 + (-0.0207818 + 0.119681 * y) * y) / (1.26264 + y * (-1.92021 + y));
  const double t = (x - mean) / width;
  albedo_ =
      std::clamp(portable::exp(-0.5 * t * t) / (width * std::sqrt(2 * std::numbers::pi)) + rest, 0.0, 1.0);
  a_ = (2.58126 * x + 0.813703 * y) * y / (1 + 0.310327 * x * x + 2.60994 * x * y);
  b_ = std::sqrt(1 - x) * (y - 1) * y * y * y /
       (0.0000254053 + 1.71228 * x - 1.71506 * x * y + 1.34174 * y * y);
  const double radius = std::sqrt(wo.x * wo.x + wo.y * wo.y);
  if (radius > 0) cosine_ = wo.x / radius, sine_ = wo.y / radius;
}

double SheenFibres::density(const Vec3d& wi) const {
  if (!(wi.z > 0)) return 0;
  const double x = cosine_ * wi.x + sine_ * wi.y, y = cosine_ * wi.y - sine_ * wi.x;
  const Vec3d w{a_ * x + b_ * wi.z, a_ * y, wi.z};
  const double stretch = a_ / dot(w, w);
  return wi.z * stretch * stretch / std::numbers::pi;
}

Vec3d SheenFibres::sample(const SquareSample& u) const {
  const Vec3d w = Vec3d(cosine_direction({0, 0, 1}, u));
  const double x = (w.x - b_ * w.z) / a_, y = w.y / a_;
  return normalize(Vec3d{cosine_ * x - sine_ * y, sine_ * x + cosine_ * y, w.z});
}

}  // namespace oktett
