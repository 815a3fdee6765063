#pragma once
/// \file Flat disks, seen from both sides.

#include <numbers>

#include "core/math.h"
#include "kernels/closed/plane.h"

namespace oktett {

struct Disk {
  static constexpr int kRoots = 1;
  using Data = DiskShape;
  static constexpr bool kNeedsSimilarity = true;

  struct Pool {
    Column<double> cx, cy, cz, nx, ny, nz, radius;  ///< unit normal
    Column<std::uint32_t> item;
    std::size_t size() const { return item.size(); }
    std::size_t bytes() const { return cx.bytes() * 7 + item.bytes(); }
  };

  template <class D>
  struct Lanes {
    Vec3<D> center, n;
    D radius;
  };

  static bool is_empty(const DiskShape& s) { return !(s.radius > 0) || !(length(s.normal) > 0); }
  static DiskShape moved(const DiskShape& s, const Affine& m) {
    return {m.point(s.center), m.inverse().normal_by_inverse(s.normal), s.radius * m.uniform_scale()};
  }
  static DiskShape shape(const Pool& p, std::size_t i) {
    return {{p.cx[i], p.cy[i], p.cz[i]}, {p.nx[i], p.ny[i], p.nz[i]}, p.radius[i]};
  }
  static void add(Pool& p, const DiskShape& s, std::uint32_t item) {
    const Vec3d n = normalize(s.normal);
    p.cx.push_back(s.center.x), p.cy.push_back(s.center.y), p.cz.push_back(s.center.z);
    p.nx.push_back(n.x), p.ny.push_back(n.y), p.nz.push_back(n.z);
    p.radius.push_back(s.radius), p.item.push_back(item);
  }
  static void add(Pool& p, const DiskShape& s, const Affine& to_world, std::uint32_t item) {
    add(p, moved(s, to_world), item);
  }
  static void finish(Pool& p) {
    for (int i = 0; i < kPoolPadding; ++i)
      for (Column<double>* c : {&p.cx, &p.cy, &p.cz, &p.nx, &p.ny, &p.nz, &p.radius}) c->push_back(0);
  }

  template <class D>
  OKTETT_INLINE static Lanes<D> load(const Pool& p, std::size_t i) {
    return {{D::load(&p.cx[i]), D::load(&p.cy[i]), D::load(&p.cz[i])},
            {D::load(&p.nx[i]), D::load(&p.ny[i]), D::load(&p.nz[i])},
            D::load(&p.radius[i])};
  }
  template <class D>
  OKTETT_INLINE static Lanes<D> broadcast(const Pool& p, std::size_t i) {
    return {{D(p.cx[i]), D(p.cy[i]), D(p.cz[i])}, {D(p.nx[i]), D(p.ny[i]), D(p.nz[i])}, D(p.radius[i])};
  }

  /// The plane through the centre, then the distance from the centre.
  template <class D>
  OKTETT_INLINE static typename D::M roots(const RayLanes<D>& ray, const Lanes<D>& s, D (&t)[1]) {
    const Vec3<D> m = sub_lanes(s.center, ray.o);
    const D speed = dot_lanes(s.n, ray.d);
    t[0] = dot_lanes(s.n, m) / speed;
    const Vec3<D> q{t[0] * ray.d.x - m.x, t[0] * ray.d.y - m.y, t[0] * ray.d.z - m.z};
    return ~(speed == D(0.0)) & (dot_lanes(q, q) <= s.radius * s.radius);
  }

  static Box bounds(const Pool& p, std::size_t i) {
    const Vec3d c{p.cx[i], p.cy[i], p.cz[i]}, n{p.nx[i], p.ny[i], p.nz[i]};
    Vec3d e;
    // The disk's extent along an axis is radius * sine of the angle between axis and normal.
    for (int k = 0; k < 3; ++k)
      e[k] = p.radius[i] * std::sqrt(std::max(0.0, 1 - n[k] * n[k])) * (1 + 0x1p-40);
    const Vec3d pad = Vec3d{1, 1, 1} * (0x1p-45 * (p.radius[i] + max_component(abs(c))));
    return {round_down(c - e - pad), round_up(c + e + pad)};
  }

  static SurfaceNearest closest(const DiskShape& s, const Affine& to_world, const Vec3d& p) {
    const Vec3d center = to_world.point(s.center);
    const Vec3d n = normalize(to_world.inverse().normal_by_inverse(s.normal));
    const double radius = s.radius * to_world.uniform_scale(), height = dot(n, p - center);
    const Vec3d flat = (p - center) - n * height;
    const double away = length(flat);
    if (away <= radius) return {height * height, p - n * height, n};
    const Vec3d edge = center + flat * (radius / away);
    return {height * height + (away - radius) * (away - radius), edge, n};
  }

  template <class D, class Fetch>
  OKTETT_INLINE static SurfacePoints<D> surface(const Pool& p, const Fetch& fetch, const HitPoints<D>& hit) {
    const Vec3<D> c{fetch(p.cx), fetch(p.cy), fetch(p.cz)}, n{fetch(p.nx), fetch(p.ny), fetch(p.nz)};
    const Vec3<D> q = hit.point();
    const Vec3<D> point = sub_lanes(q, scale_lanes(n, dot_lanes(n, sub_lanes(q, c))));
    return {point, D(0x1p-50) * (length_lanes(point) + length_lanes(c)), n};
  }

  /// uv: angle about the normal and distance from the centre, both scaled to [0, 1].
  static void uv(const Pool& p, std::size_t i, const Vec3d&, const Vec3d& point, SurfaceInteraction& s) {
    const Vec3d c{p.cx[i], p.cy[i], p.cz[i]}, n{p.nx[i], p.ny[i], p.nz[i]};
    Vec3d a, b;
    make_basis(n, a, b);
    const Vec3d q = point - c;
    s.uv = {static_cast<float>(0.5 + portable::atan2(dot(q, b), dot(q, a)) * 0.5 / std::numbers::pi),
            static_cast<float>(length(q) / p.radius[i])};
    s.tangent = Vec3f(cross(n, q) * (2 * std::numbers::pi));
    if (const double away = length(q); away > 0) s.bitangent = Vec3f(q * (p.radius[i] / away));
  }
};

}  // namespace oktett
