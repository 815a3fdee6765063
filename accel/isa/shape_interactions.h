#pragma once
/// \file Surfaces of closed-form and exact shapes for one instruction set: the operations of
/// surface_interaction() in the same order, on several hits at once.

#include "accel/accel_data.h"
#include "accel/shape_hits.h"
#include "core/affine_lanes.h"

namespace oktett {

/// Rays and distances of hits i, i + 1, ... in double.
template <class D>
struct HitPoints {
  Vec3<D> o, d;
  D t;
  using F = Simd<float, D::kWidth, typename D::Isa>;

  OKTETT_INLINE HitPoints(const ShapeHits& hits, std::size_t i)
      : o(load(hits.origin, i)), d(load(hits.direction, i)), t(to_double(F::load(hits.t + i))) {}
  OKTETT_INLINE Vec3<D> point() const { return {o.x + d.x * t, o.y + d.y * t, o.z + d.z * t}; }

 private:
  OKTETT_INLINE static Vec3<D> load(const float (&column)[3][ShapeHits::kMost], std::size_t i) {
    return to_double(Vec3<F>{F::load(column[0] + i), F::load(column[1] + i), F::load(column[2] + i)});
  }
};

/// The least floats that are not below `x`, which must be no less than 1e-37: round_up of core/box.h.
template <class D>
OKTETT_INLINE Simd<float, D::kWidth, typename D::Isa> round_up_lanes(const D& x) {
  using F = Simd<float, D::kWidth, typename D::Isa>;
  const F nearest = to_float(x);
  // Five to ten eighths of the distance to the next float lead there.
  const F next = nearest + nearest * F(0.625f * 0x1p-23f);
  return select(mask_cast<float>(to_double(nearest) < x), next, nearest);
}

/// set_position of kernels/closed/contract.h, and the normal.
template <class D>
OKTETT_INLINE void store_surface(const HitPoints<D>& hit, const Vec3<D>& p, const D& surface_error,
                                 const Vec3<D>& normal, ShapeHits& out, std::size_t i) {
  const D ulp(0x1p-23);
  const auto error = [&](const D& direction, const D& place) {
    return round_up_lanes(ulp * abs(hit.t * direction) + ulp * abs(place) + surface_error + D(1e-37));
  };
  to_float(p.x).store(out.position[0] + i), to_float(p.y).store(out.position[1] + i);
  to_float(p.z).store(out.position[2] + i);
  error(hit.d.x, p.x).store(out.position_error[0] + i), error(hit.d.y, p.y).store(out.position_error[1] + i);
  error(hit.d.z, p.z).store(out.position_error[2] + i);
  to_float(normal.x).store(out.normal[0] + i), to_float(normal.y).store(out.normal[1] + i);
  to_float(normal.z).store(out.normal[2] + i);
}

/// column[element of hit i], ... in lanes.
template <class D>
OKTETT_INLINE D gather_elements(const Column<double>& column, const ShapeHits& hits, std::size_t i) {
  double lanes[D::kWidth];
  for (int k = 0; k < D::kWidth; ++k) lanes[k] = column[hits.element[i + k]];
  return D::load(lanes);
}

template <class D>
void sphere_surfaces(const Sphere::Pool& pool, ShapeHits& hits) {
  for (std::size_t i = 0; i < hits.count; i += D::kWidth) {
    const HitPoints<D> hit(hits, i);
    const Vec3<D> c{gather_elements<D>(pool.x, hits, i), gather_elements<D>(pool.y, hits, i),
                    gather_elements<D>(pool.z, hits, i)};
    const D radius = gather_elements<D>(pool.radius, hits, i);
    const Vec3<D> m = sub_lanes(hit.point(), c);
    const D l = length_lanes(m);
    const Vec3<D> n{m.x / l, m.y / l, m.z / l};
    const Vec3<D> p{c.x + n.x * radius, c.y + n.y * radius, c.z + n.z * radius};
    store_surface(hit, p, D(0x1p-48) * (length_lanes(c) + radius), n, hits, i);
  }
}

template <class D>
void plane_surfaces(const Plane::Pool& pool, ShapeHits& hits) {
  for (std::size_t i = 0; i < hits.count; i += D::kWidth) {
    const HitPoints<D> hit(hits, i);
    const Vec3<D> n{gather_elements<D>(pool.nx, hits, i), gather_elements<D>(pool.ny, hits, i),
                    gather_elements<D>(pool.nz, hits, i)};
    const D offset = gather_elements<D>(pool.offset, hits, i);
    Vec3<D> p = hit.point();
    const D off = dot_lanes(n, p) - offset;
    p = {p.x - n.x * off, p.y - n.y * off, p.z - n.z * off};
    store_surface(hit, p, D(0x1p-50) * (length_lanes(p) + abs(offset)), n, hits, i);
  }
}

/// BoxSolid::surface for hits of one box.
template <class D>
void box_surfaces(const BoxSolid::Pool& pool, ShapeHits& hits) {
  Affine to_local;
  for (int k = 0; k < 12; ++k) to_local.m[k / 4][k % 4] = pool.m[k][hits.element[0]];
  const Affine to_world = to_local.inverse();
  const D extent(length(to_world.vector({1, 1, 1})));
  for (std::size_t i = 0; i < hits.count; i += D::kWidth) {
    const HitPoints<D> hit(hits, i);
    Vec3<D> q = map_point(to_local, hit.point());
    const Vec3<D> m{abs(q.x), abs(q.y), abs(q.z)};
    const auto x = (m.x >= m.y) & (m.x >= m.z), y = ~x & (m.y >= m.z);
    const auto side = [](const D& v) { return select(v < D(0.0), D(-1.0), D(1.0)); };
    const D zero(0.0);
    const Vec3<D> face{select(x, side(q.x), zero), select(y, side(q.y), zero),
                       select(x | y, zero, side(q.z))};
    q = {select(x, face.x, q.x), select(y, face.y, q.y), select(x | y, q.z, face.z)};
    const Vec3<D> point = map_point(to_world, q), n = map_normal(to_local, face);
    const D l = length_lanes(n);
    store_surface(hit, point, D(0x1p-46) * (length_lanes(point) + extent), Vec3<D>{n.x / l, n.y / l, n.z / l},
                  hits, i);
  }
}

/// Without vector registers one hit at a time.
template <class A>
using SurfaceLanes = Simd<double, std::is_same_v<A, ScalarIsa> ? 1 : 8, A>;

/// Spheres, planes, or one box.
template <class A>
void closed_form_surfaces_code(const Accel& accel, Kind kind, ShapeHits& hits) {
  if (kind == Kind::box)
    box_surfaces<SurfaceLanes<A>>(std::get<BoxSolid::Pool>(accel.pools), hits);
  else if (kind == Kind::sphere)
    sphere_surfaces<SurfaceLanes<A>>(std::get<Sphere::Pool>(accel.pools), hits);
  else
    plane_surfaces<SurfaceLanes<A>>(std::get<Plane::Pool>(accel.pools), hits);
}

}  // namespace oktett
