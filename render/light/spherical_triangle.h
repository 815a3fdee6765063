#pragma once
/// \file A triangle as seen from a point, and directions spread uniformly over it (Arvo 1995, "Stratified
/// sampling of spherical triangles").
///
/// Departs from the paper in its formulas: solid angle and sub-triangles are computed from half angles, which
/// keep their relative accuracy when the triangle is small.

#include "core/vec3.h"
#include "render/sampling/square_sample.h"

namespace oktett {

class SphericalTriangle {
 public:
  /// `a`, `b` and `c` are the corners relative to the point.
  SphericalTriangle(const Vec3d& a, const Vec3d& b, const Vec3d& c);

  /// In [0, 2 pi]; 0 if the point is in the plane of the triangle or is one of the corners. Computed by the
  /// formula of Van Oosterom and Strackee (1983).
  double solid_angle() const { return 2 * half_angle_; }

  /// A unit vector; uniform over the triangle if `s` is uniform. The solid angle must be > 0.
  Vec3d direction(const SquareSample& s) const;

 private:
  Vec3d a_, b_, c_;  ///< unit vectors to the corners
  double half_angle_ = 0;
};

}  // namespace oktett
