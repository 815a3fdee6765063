#include "render/optics.h"

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

float fresnel(float cosine, float eta) {
  const double c = cosine, n = eta;
  const double sin2_out = (1 - c * c) / (n * n);
  if (sin2_out >= 1) return 1;
  const double cos_out = std::sqrt(1 - sin2_out);
  const double parallel = (n * c - cos_out) / (n * c + cos_out);
  const double perpendicular = (c - n * cos_out) / (c + n * cos_out);
  return static_cast<float>((parallel * parallel + perpendicular * perpendicular) / 2);
}

}  // namespace oktett
