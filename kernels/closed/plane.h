#pragma once
/// \file Infinite planes. They have no bounds, so they stand in a list beside the tree.

#include "kernels/closed/contract.h"

namespace oktett {

/// Distance along the ray to the plane dot(n, p) = offset. Parallel lanes are false.
template <class D>
OKTETT_INLINE typename D::M plane_root(const RayLanes<D>& ray, const Vec3<D>& n, const D& offset, D& t) {
  const D speed = dot_lanes(n, ray.d);
  t = (offset - dot_lanes(n, ray.o)) / speed;
  return ~(speed == D(0.0));
}

/// Hits moved onto the plane dot(n, p) = offset, of which `n` is the unit normal.
template <class D>
OKTETT_INLINE SurfacePoints<D> plane_surface(const Vec3<D>& n, const D& offset, const HitPoints<D>& hit) {
  const Vec3<D> p = hit.point();
  const Vec3<D> point = sub_lanes(p, scale_lanes(n, dot_lanes(n, p) - offset));
  return {point, D(0x1p-50) * (length_lanes(point) + abs(offset)), n};
}

/// The foot of the perpendicular from p to the plane through `origin`, of which `n` is the unit normal.
inline SurfaceNearest closest_on_plane(const Vec3d& origin, const Vec3d& n, const Vec3d& p) {
  const double height = dot(n, p - origin);
  return {height * height, p - n * height, n};
}

struct Plane : NumberedShape<Plane, 4> {
  static constexpr int kRoots = 1;
  using Data = PlaneShape;  ///< the half-space below is inside
  static constexpr bool kNeedsSimilarity = false;

  template <class D>
  struct Lanes {
    Vec3<D> n;  ///< unit normal
    D offset;
  };
  template <class D, class Number>
  OKTETT_INLINE static Lanes<D> lanes(const Number& number) {
    return {{number(0), number(1), number(2)}, number(3)};
  }
  static std::array<double, 4> numbers(const PlaneShape& s) {
    const Vec3d n = normalize(s.normal);
    return {n.x, n.y, n.z, s.offset};
  }

  static bool is_empty(const PlaneShape& s) { return !(length(s.normal) > 0); }
  static PlaneShape moved(const PlaneShape& s, const Affine& m) {
    const Vec3d n = normalize(s.normal);
    const Vec3d p = m.point(n * s.offset);
    const Vec3d q = normalize(m.inverse().normal_by_inverse(n));
    return {q, dot(q, p)};
  }
  static PlaneShape shape(const Pool& p, std::size_t i) {
    const auto s = broadcast<double>(p, i);
    return {s.n, s.offset};
  }

  template <class D>
  OKTETT_INLINE static typename D::M roots(const RayLanes<D>& ray, const Lanes<D>& s, D (&t)[1]) {
    return plane_root(ray, s.n, s.offset, t[0]);
  }

  static bool inside(const Pool& p, std::size_t i, const Vec3d& q) {
    const auto s = broadcast<double>(p, i);
    return dot(s.n, q) < s.offset;
  }

  static SurfaceNearest closest(const PlaneShape& s, const Affine& to_world, const Vec3d& p) {
    const Vec3d n = normalize(s.normal);
    return closest_on_plane(to_world.point(n * s.offset), normalize(to_world.inverse().normal_by_inverse(n)),
                            p);
  }

  template <class D, class Fetch>
  OKTETT_INLINE static SurfacePoints<D> surface(const Pool& p, const Fetch& fetch, const HitPoints<D>& hit) {
    const auto s = lanes<D>([&](int k) { return fetch(p.number[k]); });
    return plane_surface(s.n, s.offset, hit);
  }

  /// uv: coordinates in the plane, in world units, along a basis that for the ground (0, 1, 0) is (x, -z).
  static void uv(const Pool& p, std::size_t i, const Vec3d&, const Vec3d& point, SurfaceInteraction& s) {
    const Vec3d n = broadcast<double>(p, i).n;
    const int k = dominant_axis(n);
    const Vec3d u = normalize(k == 1 ? cross(n, Vec3d{0, 0, -1}) * -1.0 : cross(Vec3d{0, 1, 0}, n));
    const Vec3d v = cross(n, u);
    s.uv = {static_cast<float>(dot(u, point)), static_cast<float>(dot(v, point))};
    s.tangent = Vec3f(u), s.bitangent = Vec3f(v);
  }
};

}  // namespace oktett
