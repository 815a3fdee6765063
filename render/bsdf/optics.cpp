#include "render/bsdf/optics.h"

#include <algorithm>
#include <cmath>

namespace oktett {

Vec3f reflect(const Vec3f& d, const Vec3f& n) { return normalize(d - n * (2 * dot(d, n))); }

Vec3f reflect_above(const Vec3f& d, const Vec3f& n, const Vec3f& ng) {
  const Vec3f r = reflect(d, n);
  const float height = dot(r, ng);
  return height < 0 ? normalize(r - ng * (2 * height)) : r;
}

std::optional<Vec3f> refract(const Vec3f& d, const Vec3f& n, float eta) {
  if (eta == 1) return d;
  const Vec3d dd(d), nd(n);
  const double ratio = 1.0 / eta;
  const double cos_in = -dot(dd, nd);
  const double sin2_out = ratio * ratio * (1 - cos_in * cos_in);
  if (sin2_out >= 1) return std::nullopt;
  const double cos_out = std::sqrt(1 - sin2_out);
  return Vec3f(normalize(dd * ratio + nd * (ratio * cos_in - cos_out)));
}

double fresnel(double cosine, double eta) {
  const double sin2_out = (1 - cosine * cosine) / (eta * eta);
  if (sin2_out >= 1) return 1;
  const double cos_out = std::sqrt(1 - sin2_out);
  const double parallel = (eta * cosine - cos_out) / (eta * cosine + cos_out);
  const double perpendicular = (cosine - eta * cos_out) / (cosine + eta * cos_out);
  return (parallel * parallel + perpendicular * perpendicular) / 2;
}

double conductor_fresnel(double cosine, double eta, double k) {
  const double c2 = cosine * cosine, s2 = 1 - c2;
  const double t = eta * eta - k * k - s2;
  const double sum = std::sqrt(t * t + 4 * eta * eta * k * k);
  const double twice = 2 * cosine * std::sqrt(std::max(0.0, (sum + t) / 2));
  const double perpendicular = (sum + c2 - twice) / (sum + c2 + twice);
  const double parallel = (c2 * sum + s2 * s2 - twice * s2) / (c2 * sum + s2 * s2 + twice * s2);
  return std::clamp(perpendicular * (1 + parallel) / 2, 0.0, 1.0);
}

}  // namespace oktett
