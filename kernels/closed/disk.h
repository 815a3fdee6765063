#pragma once
/// \file Flat disks, seen from both sides.

#include <numbers>

#include "core/math.h"
#include "kernels/closed/plane.h"

namespace oktett {

struct Disk : NumberedShape<Disk, 8> {
  static constexpr int kRoots = 1;
  using Data = DiskShape;
  static constexpr bool kNeedsSimilarity = true;

  template <class D>
  struct Lanes {
    Vec3<D> center, n;  ///< unit normal
    D radius, inner;
  };
  template <class D, class Number>
  OKTETT_INLINE static Lanes<D> lanes(const Number& number) {
    return {{number(0), number(1), number(2)}, {number(3), number(4), number(5)}, number(6), number(7)};
  }
  static std::array<double, 8> numbers(const DiskShape& s) {
    const Vec3d &c = s.center, n = normalize(s.normal);
    return {c.x, c.y, c.z, n.x, n.y, n.z, s.radius, s.inner_radius};
  }

  static bool is_empty(const DiskShape& s) { return !(s.radius > 0) || !(length(s.normal) > 0); }
  static DiskShape moved(const DiskShape& s, const Affine& m) {
    const double scale = m.uniform_scale();
    return {m.point(s.center), m.inverse().normal_by_inverse(s.normal), s.radius * scale,
            s.inner_radius * scale};
  }
  static DiskShape shape(const Pool& p, std::size_t i) {
    const auto s = broadcast<double>(p, i);
    return {s.center, s.n, s.radius, s.inner};
  }

  /// The plane through the centre, then the distance from the centre.
  template <class D>
  OKTETT_INLINE static typename D::M roots(const RayLanes<D>& ray, const Lanes<D>& s, D (&t)[1]) {
    const Vec3<D> m = sub_lanes(s.center, ray.o);
    const D speed = dot_lanes(s.n, ray.d);
    t[0] = dot_lanes(s.n, m) / speed;
    const Vec3<D> q{t[0] * ray.d.x - m.x, t[0] * ray.d.y - m.y, t[0] * ray.d.z - m.z};
    const D square = dot_lanes(q, q);
    return ~(speed == D(0.0)) & (square <= s.radius * s.radius) & (square >= s.inner * s.inner);
  }

  static Box bounds(const Pool& p, std::size_t i) {
    const auto [c, n, radius, inner] = broadcast<double>(p, i);
    Vec3d e;
    // The disk's extent along an axis is radius * sine of the angle between axis and normal.
    for (int k = 0; k < 3; ++k) e[k] = radius * std::sqrt(std::max(0.0, 1 - n[k] * n[k])) * (1 + 0x1p-40);
    const Vec3d pad = Vec3d{1, 1, 1} * (0x1p-45 * (radius + max_component(abs(c))));
    return {round_down(c - e - pad), round_up(c + e + pad)};
  }

  static SurfaceNearest closest(const DiskShape& s, const Affine& to_world, const Vec3d& p) {
    const Vec3d center = to_world.point(s.center);
    const Vec3d n = normalize(to_world.inverse().normal_by_inverse(s.normal));
    const double scale = to_world.uniform_scale(), height = dot(n, p - center);
    Vec3d flat = (p - center) - n * height;
    double away = length(flat);
    const double radius = std::clamp(away, s.inner_radius * scale, s.radius * scale);
    if (away == radius) return {height * height, p - n * height, n};
    // On the axis of the hole all points of its edge are as near.
    if (!(away > 0)) {
      Vec3d other;
      make_basis(n, flat, other);
      away = 0x1p-500, flat *= away;
    }
    const Vec3d edge = center + flat * (radius / away);
    return {height * height + (away - radius) * (away - radius), edge, n};
  }

  template <class D, class Fetch>
  OKTETT_INLINE static SurfacePoints<D> surface(const Pool& p, const Fetch& fetch, const HitPoints<D>& hit) {
    const auto s = lanes<D>([&](int k) { return fetch(p.number[k]); });
    const Vec3<D> q = hit.point();
    const Vec3<D> point = sub_lanes(q, scale_lanes(s.n, dot_lanes(s.n, sub_lanes(q, s.center))));
    return {point, D(0x1p-50) * (length_lanes(point) + length_lanes(s.center)), s.n};
  }

  /// uv: angle about the normal and distance from the centre, both scaled to [0, 1].
  static void uv(const Pool& p, std::size_t i, const Vec3d&, const Vec3d& point, SurfaceInteraction& s) {
    const auto [c, n, radius, inner] = broadcast<double>(p, i);
    Vec3d a, b;
    make_basis(n, a, b);
    const Vec3d q = point - c;
    s.uv = {static_cast<float>(0.5 + portable::atan2(dot(q, b), dot(q, a)) * 0.5 / std::numbers::pi),
            static_cast<float>(length(q) / radius)};
    s.tangent = Vec3f(cross(n, q) * (2 * std::numbers::pi));
    if (const double away = length(q); away > 0) s.bitangent = Vec3f(q * (radius / away));
  }
};

}  // namespace oktett
