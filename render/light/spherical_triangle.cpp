#include "render/light/spherical_triangle.h"

#include <algorithm>
#include <cmath>

#include "core/math.h"

namespace oktett {

/// Unit vector along the part of `v` that is perpendicular to the unit vector `axis`.
static Vec3d perpendicular(const Vec3d& v, const Vec3d& axis) { return normalize(v - axis * dot(v, axis)); }

SphericalTriangle::SphericalTriangle(const Vec3d& a, const Vec3d& b, const Vec3d& c)
    : a_(normalize(a)), b_(normalize(b)), c_(normalize(c)) {
  const double la = length(a), lb = length(b), lc = length(c);
  // The edges do not cancel where the triangle is small and far away.
  const double volume = std::abs(dot(a, cross(b - a, c - a)));
  if (!(volume > 0)) return;
  half_angle_ = portable::atan2(volume, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

Vec3d SphericalTriangle::direction(const SquareSample& s) const {
  // The first number chooses the point d of the arc from a to c for which the triangle a b d has this share
  // of the solid angle. With the angle `corner` at a, tan(arc(ad) / 2) = sin(share / 2) / (tan(arc(ab) / 2)
  // sin(corner - share / 2)).
  const Vec3d towards_b = perpendicular(b_ - a_, a_), towards_c = perpendicular(c_ - a_, a_);
  const double cos_corner = dot(towards_b, towards_c), sin_corner = length(cross(towards_b, towards_c));
  const double share = s.x * half_angle_;
  const double sin_share = portable::sin(share), cos_share = portable::cos(share);
  const double rest = std::max(0.0, sin_corner * cos_share - cos_corner * sin_share);
  const double opposite = sin_share * length(a_ + b_), adjacent = length(a_ - b_) * rest;
  const double square = opposite * opposite + adjacent * adjacent;
  if (!(square > 0)) return b_;
  // The half angle has the tangent opposite / adjacent.
  const double sin_arc = 2 * opposite * adjacent / square, below_one = 2 * opposite * opposite / square;
  const Vec3d d_minus_a = towards_c * sin_arc - a_ * below_one;

  // The second number chooses a point of the arc from b to d, uniform in the cosine of its distance from b.
  const Vec3d chord = (a_ - b_) + d_minus_a;
  const double chord_square = dot(chord, chord);
  if (!(chord_square > 0)) return b_;
  const double one_minus_cos = s.y * chord_square / 2;
  const double sin_angle = std::sqrt(std::max(0.0, one_minus_cos * (2 - one_minus_cos)));
  return normalize(b_ * (1 - one_minus_cos) + perpendicular(chord, b_) * sin_angle);
}

}  // namespace oktett
