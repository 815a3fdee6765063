#pragma once
/// \file Triangles as seen from points, and directions spread uniformly over them (Arvo 1995, "Stratified
/// sampling of spherical triangles"), in lanes.
///
/// Departs from the paper in its formulas: solid angle and sub-triangles are computed from half angles, which
/// keep their relative accuracy when the triangle is small.

#include "core/elementary.h"
#include "core/lanes.h"

namespace oktett {

template <class D>
class SphericalTriangle {
 public:
  /// `a`, `b` and `c` are the corners relative to the point.
  OKTETT_INLINE SphericalTriangle(const Vec3<D>& a, const Vec3<D>& b, const Vec3<D>& c)
      : a_(unit_lanes(a)), b_(unit_lanes(b)), c_(unit_lanes(c)) {
    const D la = length_lanes(a), lb = length_lanes(b), lc = length_lanes(c), zero(0.0);
    // The edges do not cancel where the triangle is small and far away.
    const D volume = abs(dot_lanes(a, cross_lanes(sub_lanes(b, a), sub_lanes(c, a))));
    const D half = atan2_lanes(
        volume, la * lb * lc + dot_lanes(a, b) * lc + dot_lanes(b, c) * la + dot_lanes(c, a) * lb);
    half_angle_ = select(volume > zero, half, zero);
  }

  /// In [0, 2 pi]; 0 if the point is in the plane of the triangle or is one of the corners. Computed by the
  /// formula of Van Oosterom and Strackee (1983).
  D solid_angle() const { return D(2.0) * half_angle_; }

  /// Unit vectors; uniform over the triangle if (s, t) is uniform over the unit square. The solid angle must
  /// be > 0.
  OKTETT_INLINE Vec3<D> direction(const D& s, const D& t) const {
    const D zero(0.0), one(1.0), two(2.0);
    // The first number chooses the point d of the arc from a to c for which the triangle a b d has this share
    // of the solid angle. With the angle `corner` at a, tan(arc(ad) / 2) = sin(share / 2) / (tan(arc(ab) / 2)
    // sin(corner - share / 2)).
    const Vec3<D> towards_b = perpendicular(sub_lanes(b_, a_), a_),
                  towards_c = perpendicular(sub_lanes(c_, a_), a_);
    const D cos_corner = dot_lanes(towards_b, towards_c),
            sin_corner = length_lanes(cross_lanes(towards_b, towards_c));
    D sin_share, cos_share;
    sin_cos_of_turn(s * half_angle_ * D(0.5 / std::numbers::pi), sin_share, cos_share);
    const D rest = max(zero, sin_corner * cos_share - cos_corner * sin_share);
    const D opposite = sin_share * length_lanes(a_ + b_), adjacent = length_lanes(sub_lanes(a_, b_)) * rest;
    const D square = opposite * opposite + adjacent * adjacent;
    // The half angle has the tangent opposite / adjacent.
    const D sin_arc = two * opposite * adjacent / square, below_one = two * opposite * opposite / square;
    const Vec3<D> d_minus_a = sub_lanes(towards_c * sin_arc, a_ * below_one);

    // The second number chooses a point of the arc from b to d, uniform in the cosine of its distance from b.
    const Vec3<D> chord = sub_lanes(a_, b_) + d_minus_a;
    const D chord_square = dot_lanes(chord, chord), one_minus_cos = t * chord_square * D(0.5);
    const D sin_angle = sqrt(max(zero, one_minus_cos * (two - one_minus_cos)));
    const Vec3<D> found = unit_lanes(b_ * (one - one_minus_cos) + perpendicular(chord, b_) * sin_angle);
    return select_lanes((square > zero) & (chord_square > zero), found, b_);
  }

 private:
  /// Unit vectors along the parts of `v` that are perpendicular to the unit vectors `axis`.
  static OKTETT_INLINE Vec3<D> perpendicular(const Vec3<D>& v, const Vec3<D>& axis) {
    return unit_lanes(sub_lanes(v, axis * dot_lanes(v, axis)));
  }

  Vec3<D> a_, b_, c_;  ///< unit vectors to the corners
  D half_angle_;
};

}  // namespace oktett
