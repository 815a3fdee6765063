#include "render/light/spherical_rectangle.h"

#include <algorithm>
#include <cmath>

#include "core/math.h"

namespace oktett {

SphericalRectangle::SphericalRectangle(double x0, double x1, double y0, double y1, double z)
    : x0_(x0), x1_(x1), y0_(y0), y1_(y1), z_(z), first_(angle_up_to(x0)) {
  solid_angle_ = angle_up_to(x1) - first_;
}

double SphericalRectangle::angle_up_to(double x) const {
  const auto corner = [&](double y) {
    return portable::atan2(x * y, z_ * std::sqrt(x * x + y * y + z_ * z_));
  };
  return corner(y1_) - corner(y0_);
}

void SphericalRectangle::place(const SquareSample& s, double& x, double& y) const {
  // With the elevations e0 and e1 of the edges y0 and y1, and with c = x / sqrt(x^2 + z^2), the angle up to x
  // is asin(c sin e1) - asin(c sin e0). This is that equation solved for x / z, in a form that keeps its
  // accuracy close to the plane.
  const double angle = first_ + s.x * solid_angle_;
  const double e0 = portable::atan2(y0_, z_), e1 = portable::atan2(y1_, z_);
  const double square = 4 * portable::sin((e1 - e0 + angle) / 2) * portable::sin((e1 - e0 - angle) / 2) *
                        portable::cos((angle + e0 + e1) / 2) * portable::cos((angle - e0 - e1) / 2);
  const double sine = portable::sin(angle);
  const double tangent = square > 0 ? sine / std::sqrt(square) : std::copysign(1e300, sine);
  x = std::clamp(z_ * tangent, x0_, x1_);

  // In the strip at x the solid angle is uniform in the sine of the elevation.
  const double distance_square = x * x + z_ * z_;
  const double h0 = y0_ / std::sqrt(distance_square + y0_ * y0_);
  const double h1 = y1_ / std::sqrt(distance_square + y1_ * y1_);
  const double h = h0 + s.y * (h1 - h0);
  const double cosine_square = (1 - h) * (1 + h);
  y = cosine_square > 0 ? h * std::sqrt(distance_square / cosine_square) : std::copysign(1e300, h);
  y = std::clamp(y, y0_, y1_);
}

}  // namespace oktett
