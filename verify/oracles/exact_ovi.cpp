/// \file Ovi: the distance from the piece of the profile that a point is in front of.

#include <algorithm>
#include <cmath>

#include "verify/oracles/exact_families.h"

namespace oktett {
namespace {

/// A point of the half-plane through the axis, or a way in it.
struct OnHalfPlane {
  Real rho, y;

  OnHalfPlane operator-(const OnHalfPlane& o) const { return {rho - o.rho, y - o.y}; }
  Real length() const { return std::sqrt(rho * rho + y * y); }
};
/// Above 0 if b points to the left of a.
Real turn(const OnHalfPlane& a, const OnHalfPlane& b) { return a.rho * b.y - a.y * b.rho; }

/// The circles of the profile.
struct OvusProfile {
  Real bottom, top, arc;  ///< radii
  /// The centres of the top ball and of the arc. That of the bottom ball is the origin.
  OnHalfPlane above, center;

  explicit OvusProfile(const OvusShape& s) : bottom(s.bottom_radius), top(s.top_radius) {
    arc = 2 * std::max(bottom, top), above = {0, bottom};
    // A circle that lies in another one and touches it has its centre nearer to that of the other by its
    // radius.
    const Real low = arc - bottom, high = arc - top;
    const Real y = (low * low - high * high + bottom * bottom) / (2 * bottom);
    center = {-std::sqrt(low * low - y * y), y};
  }

  /// The rays from the centre of the arc through those of the balls divide the half-plane.
  Real away(const OnHalfPlane& p) const {
    const OnHalfPlane q = p - center;
    if (turn(OnHalfPlane{0, 0} - center, q) < 0) return p.length() - bottom;
    if (turn(above - center, q) > 0) return (p - above).length() - top;
    return q.length() - arc;
  }
};

ExactOracle ovus(CaseRandom& random) {
  OvusShape s;
  s.bottom_radius = random.magnitude(-1, 0.3);
  // Any form; nearly a ball at the bottom or at the top; two equal radii.
  const double kind = random.unit();
  double ratio = 0.05 + 1.9 * random.unit();
  if (kind < 0.1) ratio = random.magnitude(-4, -1);
  if (kind > 0.8) ratio = 2 - random.magnitude(-5, -1);
  if (kind > 0.9) ratio = 1;
  s.top_radius = s.bottom_radius * ratio;
  const OvusProfile profile(s);
  const auto f = [profile](const Vec3l& p) { return profile.away({std::sqrt(p.x * p.x + p.z * p.z), p.y}); };
  const double wide = static_cast<double>(profile.arc + profile.center.rho);
  return {{s}, f, {-wide, -s.bottom_radius, -wide}, {wide, s.bottom_radius + s.top_radius, wide}};
}

}  // namespace

std::vector<ExactCase> ovus_cases() { return {{"ovus", ovus}}; }

}  // namespace oktett
