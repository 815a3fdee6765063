#pragma once
/// \file Nearest points of surfaces that are round about an axis: in the half-plane through the axis that
/// holds the point asked for, the surface is a curve.

#include <array>

#include "core/transform.h"
#include "kernels/closed/surface_points.h"

namespace oktett {

/// A point of the half-plane: the distance from the axis, and the place along it.
struct HalfPlanePoint {
  double rho, z;
};

/// A point of the profile that is nearest to another one, and the normal there, of any length but zero.
struct HalfPlaneNearest {
  double d2;
  HalfPlanePoint at, normal;
};

/// Takes the point `at` if it is nearer to p than `best`. Where two pieces meet, that which faces p more
/// counts, so that the side on which p lies follows from the normal.
void keep_nearer(const HalfPlanePoint& p, const HalfPlanePoint& at, const HalfPlanePoint& normal,
                 HalfPlaneNearest& best);
/// The same for the segment from a to b, which are not one point. The normal is to the right of the way from
/// a to b.
void keep_segment(const HalfPlanePoint& p, const HalfPlanePoint& a, const HalfPlanePoint& b,
                  HalfPlaneNearest& best);

/// A space in which a surface is round about an axis, as it stands in the world.
class RoundFrame {
 public:
  /// `axis` is 0 to 2; what is said below of z is meant of that axis, and of x and y of those that follow it.
  explicit RoundFrame(const Affine& own_to_world, int axis = 2);

  /// Whether the surface is still round in the world: the axes stay perpendicular, and x and y have one
  /// scale.
  bool is_round() const;
  /// Whether z has this scale, too.
  bool is_similar() const;
  double radial_scale() const { return x_length_; }
  double axial_scale() const { return z_length_; }

  /// Where p lies, in lengths of the world. On the axis itself the half-plane is that through +x.
  HalfPlanePoint in_profile(const Vec3d& p);
  /// The point of the profile in the half-plane of the last in_profile(), in the world.
  SurfaceNearest in_world(const HalfPlaneNearest& nearest) const;
  /// The same for a profile in lengths of the own space; is_similar() must hold.
  SurfaceNearest scaled_in_world(const HalfPlaneNearest& nearest) const;

 private:
  Vec3d origin_, x_, y_, z_;
  double x_length_, y_length_, z_length_;
  Vec3d axis_, out_;  ///< unit vectors of the half-plane
};

/// The nearest point of a frustum about the z axis of `frame`: the side from radius r0 at z = -h to r1 at z =
/// h and, unless `open`, the disks at its ends. In lengths of the world.
SurfaceNearest closest_on_frustum(RoundFrame& frame, double r0, double r1, double h, bool open,
                                  const Vec3d& p);

}  // namespace oktett
