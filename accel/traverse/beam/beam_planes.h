#pragma once
/// \file Unbounded planes against a beam. In the plane of the beam the inverse depth at which a ray meets
/// such a plane is a linear function of (x, y). Before the tree, it bounds the rays. After the tree, the
/// kernel decides for the rays that have met nothing surely nearer. The bounds are derived in
/// docs/numerics.md.

#include <cmath>

#include "accel/traverse/beam/beam_shapes.h"

namespace oktett {

/// The plane n.p = offset as seen from the apex.
struct BeamPlane {
  float c, cx, cy;  ///< the inverse depth is c + cx x + cy y
  float error;      ///< bound on the error of that
  double height;    ///< of the apex over the plane, along n
  bool known;       ///< the apex is so far from the plane that the error is bounded
};

template <class A>
BeamPlane beam_plane(const Plane::Pool& pool, std::uint32_t k, const BeamRays<A>& beam) {
  const double n[3] = {pool.nx[k], pool.ny[k], pool.nz[k]};
  double a[3], at = 0, size = std::fabs(pool.offset[k]);
  for (int i = 0; i < 3; ++i) {
    const double p = beam.apex[i];
    a[i] = n[beam.axis[i]], at += a[i] * p, size += std::fabs(p);
  }
  if (beam.mirrored) a[2] = -a[2];
  const double depth = pool.offset[k] - at;
  BeamPlane plane;
  plane.c = static_cast<float>(a[2] / depth), plane.height = -depth;
  plane.cx = static_cast<float>(a[0] / depth), plane.cy = static_cast<float>(a[1] / depth);
  plane.error = 0x1p-19f * (std::fabs(plane.c) + std::fabs(plane.cx) + std::fabs(plane.cy)) * beam.spread;
  // margin * 2^46 is the greatest coordinate of the apex and the scene.
  plane.known = std::fabs(depth) > 0x1p-12 * (size + beam.margin * 0x1p46) && plane.error < 0x1p60f;
  return plane;
}

/// Calls f(pool, k) for each plane among the shapes without bounds.
template <class Function>
OKTETT_INLINE void each_plane(const Accel& accel, Function&& f) {
  const auto& pool = std::get<Plane::Pool>(accel.pools);
  for (const LeafEntry& leaf : accel.unbounded)
    if (leaf.kind == Kind::plane)
      for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k) f(pool, k);
}

/// Inverse depths at which a group meets a plane.
template <class A>
OKTETT_INLINE Simd<float, kBeamGroup, A> plane_depths(const BeamPlane& plane, const BeamRays<A>& beam,
                                                      int g) {
  using F = Simd<float, kBeamGroup, A>;
  const int base = g * kBeamGroup;
  return fast_fma(F(plane.cx), F::load(beam.x + base),
                  fast_fma(F(plane.cy), F::load(beam.y + base), F(plane.c)));
}

/// Before the tree: ends rays at planes that they surely meet, since what lies surely beyond is not needed.
template <class A>
OKTETT_NOINLINE void bound_by_planes(const Accel& accel, BeamRays<A>& beam) {
  using F = Simd<float, kBeamGroup, A>;
  bool bounded = false;
  each_plane(accel, [&](const Plane::Pool& pool, std::uint32_t k) {
    const BeamPlane plane = beam_plane(pool, k, beam);
    if (!plane.known) return;
    for (unsigned rest = beam.groups; rest != 0; rest &= rest - 1) {
      const int base = __builtin_ctz(rest) * kBeamGroup;
      const F s = plane_depths(plane, beam, __builtin_ctz(rest)), least = s - F(plane.error);
      const F was = F::load(beam.hit_lo + base);
      const auto sure = (F::load(beam.hit_hi + base) < least) & (s + F(plane.error) < F(beam.near_s)) &
                        (F(kBeamLeast * kBeamLeast) < least);
      select(sure, max(least, was), was).store(beam.hit_lo + base);
    }
    bounded = true;
  });
  if (!bounded) return;
  for (unsigned rest = beam.groups; rest != 0; rest &= rest - 1) beam.refresh(__builtin_ctz(rest));
  beam.refresh_window();
}

/// The rays of a group that may meet a plane nearer than what they have met so far.
template <class A>
OKTETT_INLINE unsigned rays_near_plane(const BeamRays<A>& beam, const BeamPlane& plane, int g) {
  using F = Simd<float, kBeamGroup, A>;
  const F most = plane_depths(plane, beam, g) + F(plane.error);
  return bits(~(most <= F::load(beam.hit_lo + g * kBeamGroup))) & 0xffff;
}

/// The rays of a group that may cross a plane on their way to the apex, where they end: not those that start
/// on the apex's side. The kernel's numerator is the same number, so its sign is exact.
template <Query Q, class A>
OKTETT_INLINE unsigned rays_across_plane(const BeamTask<Q, A>& task, const Plane::Pool& pool, std::uint32_t k,
                                         const BeamPlane& plane, int g) {
  using F = Simd<float, kBeamGroup, A>;
  using D = Simd<double, kBeamGroup, A>;
  const std::size_t base = static_cast<std::size_t>(g) * kBeamGroup;
  const Vec3<D> o = to_double(load_rays<F>(task.beam, task.rays, base).o);
  const D height = dot_lanes(Vec3<D>{D(pool.nx[k]), D(pool.ny[k]), D(pool.nz[k])}, o) - D(pool.offset[k]);
  const D same = plane.height < 0 ? -height : height, most(std::fabs(plane.height) * 0x1p18);
  return bits(~mask_cast<float>((D(0.0) < same) & (same <= most))) & 0xffff;
}

/// After the tree: the hits with planes.
template <Query Q, class A>
OKTETT_NOINLINE void decide_planes(BeamTask<Q, A>& task) {
  each_plane(task.accel, [&](const Plane::Pool& pool, std::uint32_t k) {
    const BeamPlane plane = beam_plane(pool, k, task.beam);
    for (unsigned rest = task.beam.groups; rest != 0; rest &= rest - 1) {
      const int g = __builtin_ctz(rest);
      unsigned rays = open_rays(task.beam, g);
      if (plane.known && rays != 0)
        rays &= task.beam.at_end ? rays_across_plane(task, pool, k, plane, g)
                                 : rays_near_plane(task.beam, plane, g);
      if (rays != 0) closed_group<Plane>(task, pool, k, g, rays);
    }
  });
}

}  // namespace oktett
