#include "kernels/exact/ovus.h"

#include <algorithm>
#include <cmath>

#include "core/math.h"
#include "kernels/exact/surface_uv.h"

namespace oktett {
namespace {

/// The cap of a ball about (0, 0, center), where it is touched from outside by the arc about (-m, 0).
OvusElement::Cap cap_of(double center, double radius, double m) {
  // The line from the centre of the arc through that of the ball ends at the point of contact.
  const double share = 1 / (1 - radius), rim = m * radius * share;
  return {center, radius, center * share, rim * rim};
}

/// The shape in units of the arc's radius.
OvusElement element_of(const OvusShape& s) {
  const double a = s.bottom_radius, b = s.top_radius;
  // With radii p and q the centres y and y + p of the balls have the distances 1 - p and 1 - q from the
  // centre of the arc: y^2 + m^2 = (1 - p)^2 and (y + p)^2 + m^2 = (1 - q)^2. One of p and q is 1/2.
  if (b <= a) {
    const double q = 0.5 * (b / a), rest = 1 - q, m = rest * std::sqrt(q * (2 - q));
    return {cap_of(rest * rest - 0.5, 0.5, m), cap_of(rest * rest, q, m), m};
  }
  const double p = 0.5 * (a / b), top = 1 - 0.375 / p;
  const double m = std::sqrt(3 * ((2 * a - b) / b) * (3 - 4 * p)) / (8 * p);
  return {cap_of(top - p, p, m), cap_of(top, 0.5, m), m};
}

/// The angle of a normal from the bottom up, where the egg's radius is `rho`, at the end of the cap.
double end_angle(const OvusElement& e, const OvusElement::Cap& cap) {
  return portable::atan2(std::sqrt(cap.rim2) + e.m, -cap.end);
}

}  // namespace

void Ovus::add(Pool& pool, const OvusShape& s, const ExactPlace& place) {
  const double a = s.bottom_radius, b = s.top_radius, size = 2 * std::max(a, b);
  if (!(a > 0 && b > 0 && b < 2 * a && std::isfinite(size))) return;
  const OvusElement e = element_of(s);
  // The own z axis is y.
  Affine to_shape;
  to_shape.m[0] = {0, size, 0, 0};
  to_shape.m[1] = {0, 0, size, -size * e.bottom.center};
  to_shape.m[2] = {size, 0, 0, 0};
  add_element(pool, e, place.to_world * to_shape, place);
  // Between the planes the egg is widest where z = 0.
  const bool waist = e.bottom.end < 0 && 0 < e.top.end;
  const double wide = waist ? 1 - e.m : 0.5;
  add_cell(pool, {-wide, -wide, e.bottom.center - e.bottom.radius},
           {wide, wide, e.top.center + e.top.radius});
}

Box Ovus::world_bounds(const Pool& pool, std::size_t i) {
  const OvusElement& e = pool.elements[i];
  const ExactFrame& frame = pool.frames[i];
  const Affine& to_world = frame.to_world;
  const Vec3d origin = to_world.point({0, 0, 0});
  double lengths = length(origin);
  Vec3d column[3], reach[2];
  for (int k = 0; k < 3; ++k) {
    Vec3d unit{0, 0, 0};
    unit[k] = 1, column[k] = to_world.vector(unit), lengths += length(column[k]);
  }
  // How far the egg reaches along the normal n: as far as the piece that has this normal.
  const auto support = [&](const Vec3d& n) {
    const double size = length(n), rho = std::sqrt(n.x * n.x + n.y * n.y);
    if (n.z < e.bottom.end * size) return e.bottom.center * n.z + e.bottom.radius * size;
    if (n.z > e.top.end * size) return e.top.center * n.z + e.top.radius * size;
    return size - e.m * rho;
  };
  for (int k = 0; k < 3; ++k) {
    const Vec3d n{column[0][k], column[1][k], column[2][k]};
    reach[0][k] = origin[k] - support(-n), reach[1][k] = origin[k] + support(n);
  }
  // Taking a ray into the own space may displace it by a few roundings of the coordinates.
  Vec3d pad = displacement(frame.to_own, to_world, max(abs(reach[0]), abs(reach[1])));
  pad += Vec3d{1, 1, 1} * (0x1p-44 * lengths);
  return {round_down(reach[0] - pad), round_up(reach[1] + pad)};
}

SurfaceUv Ovus::uv(const Pool& pool, std::size_t i, int, const Vec3d& p) {
  const OvusElement& e = pool.elements[i];
  const double low = end_angle(e, e.bottom), high = end_angle(e, e.top);
  // A normal at the angle a is at the length base + radius a along the profile.
  const double torus_base = (e.bottom.radius - 1) * low, top_base = torus_base + (1 - e.top.radius) * high;
  const double whole = top_base + e.top.radius * std::numbers::pi;
  const SpaceFunction rho = radius_of(component(p, 0), component(p, 1)), z = component(p, 2);
  const auto along = [&](const SpaceFunction& across, double center, double radius, double base) {
    return (angle_of(across, (z - center) * -1) * radius + base) / whole;
  };
  const SpaceFunction v = p.z < e.bottom.end ? along(rho, e.bottom.center, e.bottom.radius, 0)
                          : p.z > e.top.end  ? along(rho, e.top.center, e.top.radius, top_base)
                                             : along(rho + e.m, 0, 1, torus_base);
  return {turn_around_z(p), v};
}

bool Ovus::is_kept_by(const Affine& to_world) { return RoundFrame(to_world).is_similar(); }

SurfaceNearest Ovus::closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& p) {
  const OvusElement& e = pool.elements[i];
  RoundFrame frame(to_world);
  const double scale = frame.radial_scale();
  const HalfPlanePoint at = frame.in_profile(p);
  HalfPlaneNearest best{std::numeric_limits<double>::infinity(), {}, {}};
  // An arc about (rho, z) whose normals have z from `low` to `high`. Beyond its ends the next piece is
  // nearer.
  const auto keep = [&](double rho, double z, double radius, double low, double high) {
    const HalfPlanePoint away{at.rho - rho * scale, at.z - z * scale};
    const double distance = std::sqrt(away.rho * away.rho + away.z * away.z), r = radius * scale;
    HalfPlanePoint n{1, 0};
    if (distance > 0) n = {away.rho / distance, away.z / distance};
    if (n.z < low || n.z > high) {
      n.z = std::clamp(n.z, low, high);
      n.rho = std::sqrt((1 - n.z) * (1 + n.z));
    }
    const HalfPlanePoint foot{rho * scale + r * n.rho, z * scale + r * n.z};
    const double x = at.rho - foot.rho, y = at.z - foot.z, d2 = x * x + y * y;
    if (d2 < best.d2) best = {d2, foot, n};
  };
  keep(-e.m, 0, 1, e.bottom.end, e.top.end);
  keep(0, e.bottom.center, e.bottom.radius, -1, e.bottom.end);
  keep(0, e.top.center, e.top.radius, e.top.end, 1);
  return frame.in_world(best);
}

}  // namespace oktett
