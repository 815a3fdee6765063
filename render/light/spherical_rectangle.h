#pragma once
/// \file Rectangles as seen from points, and places on them whose directions are spread uniformly (Urena,
/// Fajardo, King 2013, "An area-preserving parametrization for spherical rectangles"), in lanes.
///
/// Departs from the paper in its formulas: angles between edges are differences of elevations, whose sines
/// and cosines need no elementary functions.

#include "core/elementary.h"

namespace oktett {

/// The rectangle [x0, x1] x [y0, y1] in a plane at distance `z` > 0 from the origin.
template <class D>
class SphericalRectangle {
 public:
  OKTETT_INLINE SphericalRectangle(const D& x0, const D& x1, const D& y0, const D& y1, const D& z)
      : x0_(x0), x1_(x1), y0_(y0), y1_(y1), z_(z), first_(angle_up_to(x0)) {
    solid_angle_ = angle_up_to(x1) - first_;
  }

  /// In (0, 2 pi). The absolute error is about 1e-15.
  const D& solid_angle() const { return solid_angle_; }

  /// Coordinates in the plane for the point (s, t) of the unit square; the directions from the origin are
  /// uniform if the point is uniform.
  OKTETT_INLINE void place(const D& s, const D& t, D& x, D& y) const {
    const D zero(0.0), one(1.0);
    // With the elevations e0 and e1 of the edges y0 and y1, and with c = x / sqrt(x^2 + z^2), the angle up to
    // x is asin(c sin e1) - asin(c sin e0). This is that equation solved for x / z, in a form that keeps its
    // accuracy close to the plane.
    const HalfElevation low(y0_, z_), high(y1_, z_);
    const D sin_difference = high.sine * low.cosine - high.cosine * low.sine;
    const D cos_difference = high.cosine * low.cosine + high.sine * low.sine;
    const D sin_sum = high.sine * low.cosine + high.cosine * low.sine;
    const D cos_sum = high.cosine * low.cosine - high.sine * low.sine;
    const D angle = first_ + s * solid_angle_;
    D sine, cosine;  // of half the angle
    sin_cos_of_turn(abs(angle) * D(0.25 / std::numbers::pi), sine, cosine);
    sine = select(angle < zero, -sine, sine);
    const D square = D(4.0) * (sin_difference * cosine + cos_difference * sine) *
                     (sin_difference * cosine - cos_difference * sine) * (cosine * cos_sum - sine * sin_sum) *
                     (cosine * cos_sum + sine * sin_sum);
    const D whole_sine = D(2.0) * sine * cosine;
    const D far = select(whole_sine < zero, D(-1e300), D(1e300));
    const D tangent = select(square > zero, whole_sine / sqrt(square), far);
    x = within(z_ * tangent, x0_, x1_);

    // In the strip at x the solid angle is uniform in the sine of the elevation.
    const D distance_square = x * x + z_ * z_;
    const D h0 = y0_ / sqrt(distance_square + y0_ * y0_), h1 = y1_ / sqrt(distance_square + y1_ * y1_);
    const D h = h0 + t * (h1 - h0), cosine_square = (one - h) * (one + h);
    const D beyond = select(h < zero, D(-1e300), D(1e300));
    y = within(select(cosine_square > zero, h * sqrt(distance_square / cosine_square), beyond), y0_, y1_);
  }

 private:
  /// Sine and cosine of half the angle whose tangent is y / z.
  struct HalfElevation {
    OKTETT_INLINE HalfElevation(const D& y, const D& z) {
      const D along = z + sqrt(y * y + z * z), scale = D(1.0) / sqrt(along * along + y * y);
      sine = y * scale, cosine = along * scale;
    }
    D sine, cosine;
  };

  /// The solid angle between x = 0 and `x`, negative for x < 0: the difference of two angles below pi / 2,
  /// as the angle between two complex numbers.
  OKTETT_INLINE D angle_up_to(const D& x) const {
    const D low = z_ * sqrt(x * x + y0_ * y0_ + z_ * z_), high = z_ * sqrt(x * x + y1_ * y1_ + z_ * z_);
    // (high + i x y1) times the conjugate of (low + i x y0).
    return atan2_lanes(x * (y1_ * low - y0_ * high), high * low + x * x * y0_ * y1_);
  }

  D x0_, x1_, y0_, y1_, z_;
  D first_, solid_angle_;
};

}  // namespace oktett
