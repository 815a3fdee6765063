#include "kernels/exact/round_profile.h"

#include <cmath>

namespace oktett {

static Vec3d column(const Affine& a, int k) { return {a.m[0][k], a.m[1][k], a.m[2][k]}; }

/// Equal but for the rounding of a few maps.
static bool same_length(double a, double b) { return std::abs(a - b) <= 1e-12 * a; }

RoundFrame::RoundFrame(const Affine& m, int axis)
    : origin_(column(m, 3)),
      x_(column(m, (axis + 1) % 3)),
      y_(column(m, (axis + 2) % 3)),
      z_(column(m, axis)),
      x_length_(length(x_)),
      y_length_(length(y_)),
      z_length_(length(z_)),
      axis_(z_ / z_length_),
      out_(x_ / x_length_) {}

bool RoundFrame::is_round() const {
  const auto perpendicular = [](const Vec3d& a, const Vec3d& b, double lengths) {
    return std::abs(dot(a, b)) <= 1e-12 * lengths;
  };
  return same_length(x_length_, y_length_) && perpendicular(x_, y_, x_length_ * y_length_) &&
         perpendicular(x_, z_, x_length_ * z_length_) && perpendicular(y_, z_, y_length_ * z_length_);
}

bool RoundFrame::is_similar() const { return is_round() && same_length(x_length_, z_length_); }

HalfPlanePoint RoundFrame::in_profile(const Vec3d& p) {
  const Vec3d d = p - origin_;
  // The part across the axis has no cancellation in these coordinates, even for points near the axis.
  const Vec3d x = x_ / x_length_, y = y_ / y_length_;
  const double along_x = dot(d, x), along_y = dot(d, y);
  const double rho = std::sqrt(along_x * along_x + along_y * along_y);
  out_ = rho > 0 ? x * (along_x / rho) + y * (along_y / rho) : x;
  return {rho, dot(d, axis_)};
}

SurfaceNearest RoundFrame::in_world(const HalfPlaneNearest& nearest) const {
  const auto vector = [&](const HalfPlanePoint& v) { return out_ * v.rho + axis_ * v.z; };
  return {nearest.d2, origin_ + vector(nearest.at), normalize(vector(nearest.normal))};
}

SurfaceNearest RoundFrame::scaled_in_world(const HalfPlaneNearest& nearest) const {
  const double s = x_length_;
  return in_world({nearest.d2 * s * s, {nearest.at.rho * s, nearest.at.z * s}, nearest.normal});
}

/// The same for what is `away` from p.
static void keep_away(const HalfPlanePoint& away, const HalfPlanePoint& at, const HalfPlanePoint& normal,
                      HalfPlaneNearest& best) {
  const double d2 = away.rho * away.rho + away.z * away.z;
  const auto facing = [&](const HalfPlanePoint& n) { return std::abs(away.rho * n.rho + away.z * n.z); };
  if (d2 < best.d2 || (d2 == best.d2 && facing(normal) > facing(best.normal))) best = {d2, at, normal};
}

void keep_nearer(const HalfPlanePoint& p, const HalfPlanePoint& at, const HalfPlanePoint& normal,
                 HalfPlaneNearest& best) {
  keep_away({p.rho - at.rho, p.z - at.z}, at, normal, best);
}

void keep_segment(const HalfPlanePoint& p, const HalfPlanePoint& a, const HalfPlanePoint& b,
                  HalfPlaneNearest& best) {
  const double x = b.rho - a.rho, y = b.z - a.z, fx = p.rho - a.rho, fy = p.z - a.z;
  const double t = (fx * x + fy * y) / (x * x + y * y);
  HalfPlanePoint at = a, away{fx, fy};
  if (t >= 1) at = b, away = {p.rho - b.rho, p.z - b.z};
  if (t > 0 && t < 1) at = {a.rho + t * x, a.z + t * y}, away = {fx - t * x, fy - t * y};
  const double size = std::sqrt(x * x + y * y);
  keep_away(away, at, {y / size, -x / size}, best);
}

SurfaceNearest closest_on_frustum(RoundFrame& frame, double r0, double r1, double h, bool open,
                                  const Vec3d& p) {
  const HalfPlanePoint at = frame.in_profile(p);
  HalfPlaneNearest best{std::numeric_limits<double>::infinity(), {}, {}};
  keep_segment(at, {r0, -h}, {r1, h}, best);
  if (!open) {
    if (r0 > 0) keep_segment(at, {0, -h}, {r0, -h}, best);
    if (r1 > 0) keep_segment(at, {r1, h}, {0, h}, best);
  }
  return frame.in_world(best);
}

}  // namespace oktett
