#pragma once
/// \file A rectangle as seen from a point, and places on it whose directions are spread uniformly (Urena,
/// Fajardo, King 2013, "An area-preserving parametrization for spherical rectangles").

#include "render/sampling/square_sample.h"

namespace oktett {

/// The rectangle [x0, x1] x [y0, y1] in a plane at distance `z` > 0 from the origin.
class SphericalRectangle {
 public:
  SphericalRectangle(double x0, double x1, double y0, double y1, double z);

  /// In (0, 2 pi). The absolute error is about 1e-15.
  double solid_angle() const { return solid_angle_; }

  /// Coordinates in the plane; the directions from the origin are uniform if `s` is uniform.
  void place(const SquareSample& s, double& x, double& y) const;

 private:
  /// The solid angle between x = 0 and `x`, negative for x < 0.
  double angle_up_to(double x) const;

  double x0_, x1_, y0_, y1_, z_;
  double first_, solid_angle_;
};

}  // namespace oktett
