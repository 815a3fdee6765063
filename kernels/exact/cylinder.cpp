#include "kernels/exact/cylinder.h"

#include <cmath>

#include "kernels/exact/surface_uv.h"

namespace oktett {

Affine along_axis(const Vec3d& from, const Vec3d& to, double radius) {
  const Vec3d half = (to - from) * 0.5, middle = from + half;
  Vec3d u, v;
  make_basis(normalize(half), u, v);
  u *= radius, v *= radius;
  Affine a;
  for (int k = 0; k < 3; ++k) a.m[k] = {u[k], v[k], half[k], middle[k]};
  return a;
}

Box frustum_bounds(const ExactFrame& frame, double r0, double r1) {
  const Affine& to_world = frame.to_world;
  const Vec3d u = to_world.vector({1, 0, 0}), v = to_world.vector({0, 1, 0});
  Box b;
  for (int end = 0; end < 2; ++end) {
    const Vec3d c = to_world.point({0, 0, end == 0 ? -1.0 : 1.0});
    const double r = end == 0 ? r0 : r1;
    // Taking a ray into the own space may displace it by a few roundings of the coordinates.
    const double pad = 0x1p-44 * (length(c) + length(u) + length(v) + length(to_world.vector({0, 0, 1})));
    // A circle of radius r reaches r (u_k cos + v_k sin) along axis k.
    Vec3d e;
    for (int k = 0; k < 3; ++k) e[k] = r * std::sqrt(u[k] * u[k] + v[k] * v[k]) + pad;
    e += displacement(frame.to_own, to_world, abs(c) + e);
    b.grow(Box{round_down(c - e), round_up(c + e)});
  }
  return b;
}

SurfaceUv frustum_uv(int part, double radius, const Vec3d& p) {
  const SpaceFunction v =
      part == 0 ? component(p, 2) * 0.5 + 0.5 : radius_of(component(p, 0), component(p, 1)) / radius;
  return {turn_around_z(p), v};
}

void Cylinder::add(Pool& pool, const CylinderShape& s, const ExactPlace& place) {
  const double axis = length(s.to - s.from);
  if (!(s.radius > 0 && axis > 0 && std::isfinite(s.radius) && std::isfinite(axis))) return;
  add_element(pool, {s.open}, place.to_world * along_axis(s.from, s.to, s.radius), place);
  add_cell(pool, {-1, -1, -1}, {1, 1, 1});
}

Box Cylinder::world_bounds(const Pool& pool, std::size_t i) { return frustum_bounds(pool.frames[i], 1, 1); }

bool Cylinder::inside(const Pool&, std::size_t, const Vec3d& p) {
  return p.x * p.x + p.y * p.y < 1 && std::abs(p.z) < 1;
}

SurfaceUv Cylinder::uv(const Pool&, std::size_t, int part, const Vec3d& p) { return frustum_uv(part, 1, p); }

bool Cylinder::is_kept_by(const Affine& to_world) { return RoundFrame(to_world).is_round(); }

SurfaceNearest Cylinder::closest(const Pool& pool, std::size_t i, const Affine& to_world, const Vec3d& p) {
  RoundFrame frame(to_world);
  const double radius = frame.radial_scale();
  return closest_on_frustum(frame, radius, radius, frame.axial_scale(), pool.elements[i].open, p);
}

}  // namespace oktett
