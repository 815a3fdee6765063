#pragma once
/// \file Closed-form and exact shapes against the groups of a beam: the rays of a group that may meet a shape
/// go to its kernel straight from the columns of the batch.

#include <cmath>

#include "accel/exact_table.h"
#include "accel/traverse/beam/beam_rays.h"
#include "accel/traverse/beam/beam_task.h"
#include "kernels/closed/sphere.h"

namespace oktett {

// ---- A sphere against the groups of a beam in float: which rays surely miss it, and which surely hit it.
// The bounds are derived in docs/numerics.md.

/// A sphere as seen from the apex. The line (x, y) passes its centre at a distance whose square is
/// depth^2 (dx^2 + dy^2 + (dx y - dy x)^2) / (1 + x^2 + y^2), with (dx, dy) the distance from the centre.
struct BeamSphere {
  float x, y;          ///< the centre
  float outer, inner;  ///< squares of the radius over the depth, more and less by the error
  float near, far;     ///< bounds of its depth
  bool may_be_sure;    ///< the whole sphere is farther than 1 / near_s, see BeamRays

  /// False if the sphere is too near or too large for the bounds.
  template <class A>
  OKTETT_INLINE bool set(const Sphere::Pool& pool, std::uint32_t k, const BeamRays<A>& beam) {
    const auto [c, radius] = Sphere::broadcast<double>(pool, k);
    double m[3];
    for (int i = 0; i < 3; ++i) m[i] = c[beam.axis[i]] - beam.apex[i];
    if (beam.mirrored) m[2] = -m[2];
    const double inverse = 1 / m[2], cx = m[0] * inverse, cy = m[1] * inverse, size = radius * inverse;
    if (!(m[2] > 0 && size <= 0.5 && std::fabs(cx) <= 4 && std::fabs(cy) <= 4)) return false;
    const double spread = std::max({double{beam.spread}, std::fabs(cx), std::fabs(cy)});
    const double error = 0x1p-20 * spread * (1 + spread) + 0x1p-19 * size +
                         4 * (double{beam.slip} + beam.behind + beam.margin) * inverse;
    x = static_cast<float>(cx), y = static_cast<float>(cy);
    const double more = size + error, less = size - error;
    outer = static_cast<float>(more * more), inner = less > 0 ? static_cast<float>(less * less) : 0.0f;
    near = static_cast<float>((m[2] - radius) * (1 - 0x1p-20)),
    far = static_cast<float>((m[2] + radius) * (1 + 0x1p-20));
    may_be_sure = near * beam.near_s > 1 + 0x1p-20f;
    return error < 1;
  }

  template <class A>
  OKTETT_INLINE void filter(const BeamRays<A>& beam, unsigned groups, BeamLanes& lanes) const {
    using F = Simd<float, kBeamGroup, A>;
    const F one(1.0f);
    for (; groups != 0; groups &= groups - 1) {
      const int g = __builtin_ctz(groups), base = g * kBeamGroup;
      const F rx = F::load(beam.x + base), ry = F::load(beam.y + base), dx = rx - F(x), dy = ry - F(y);
      const F turn = fast_fms(dx, ry, dy * rx), square = fast_fma(dx, dx, fast_fma(dy, dy, turn * turn));
      const F length = fast_fma(rx, rx, fast_fma(ry, ry, one));
      // A ray that has met something before the sphere begins misses it, too.
      const auto misses = (F(outer) * length < square) | (one < F(near) * F::load(beam.hit_lo + base));
      const auto sure = (square < F(inner) * length) & (F(far) * F::load(beam.hit_hi + base) < one);
      const unsigned maybe = lanes.maybe[g] & ~bits(misses);
      lanes.maybe[g] = static_cast<std::uint16_t>(maybe);
      lanes.sure[g] = static_cast<std::uint16_t>(may_be_sure ? maybe & bits(sure) : 0);
    }
  }
};

// ---- Closed-form and exact shapes against the groups of a beam.

/// The part of a beam that the code of a surface reads.
template <class A>
BeamView beam_view(const BeamRays<A>& beam, bool any) {
  BeamView v{beam.x, beam.y, beam.hit_lo, beam.hit_hi, {}, {}, beam.mirrored, 0, 0, beam.near_s, false};
  for (int k = 0; k < 3; ++k) v.axis[k] = beam.axis[k], v.apex[beam.axis[k]] = beam.apex[k];
  const BeamWindow& w = beam.window;
  v.farthest = std::max({std::fabs(w.x_lo), std::fabs(w.x_hi), std::fabs(w.y_lo), std::fabs(w.y_hi)});
  v.slack = beam.slip + beam.behind + beam.margin, v.any = any && beam.at_end;
  return v;
}

/// Rays [at, at + width) of a beam as kernels of shapes take them: without components of the direction that
/// count as zero, and for the nearest hit only up to the decided hit so far.
template <class F, Query Q, class A>
OKTETT_INLINE RayLanes<F> shape_rays(const BeamTask<Q, A>& task, std::size_t at) {
  RayLanes<F> r = load_rays<F>(task.beam, task.rays, at);
  r.d = flush_direction(r.d);
  if constexpr (Q == Query::closest) {
    const HitSpan& hits = task.out.hits;
    const int rest = static_cast<int>(hits.size - at);
    r.tmax = min(rest >= F::kWidth ? F::load(hits.t + at) : F::load_front(hits.t + at, rest), r.tmax);
  }
  return r;
}

/// Keeps the hits of rays [at, at + width) in `met` with one item. All are within their ray's range.
template <class F, class A>
OKTETT_INLINE void keep_hits(const HitSpan& hits, BeamRays<A>& beam, const RayLanes<F>& rays, std::size_t at,
                             unsigned met, const HitLanes<F>& h, std::uint32_t item) {
  using I = Simd<std::int32_t, F::kWidth, A>;
  if (const unsigned same = met & bits(h.t == rays.tmax); OKTETT_UNLIKELY(same != 0))
    each_hit(same, h, [&](int k, float t, float u, float v) {
      const std::size_t i = at + static_cast<std::size_t>(k);
      if (hits.item[i] != kNoId && !comes_first({t, u, v, item, kNoId}, hits[i])) met &= ~(1u << k);
    });
  if (met == 0) return;
  const F* d[3] = {&rays.d.x, &rays.d.y, &rays.d.z};
  store_hits(hits, beam, *d[beam.axis[2]], at, met, h, I(static_cast<std::int32_t>(item)), I(-1));
}

/// The rays in `lanes` of group `g` against one shape, N at once. `test(rays, lanes, hit, part)` is
/// the shape's kernel for the rays from place `part` of the group on; it returns the lanes that are hit.
template <int N, Query Q, class A, class Test>
OKTETT_INLINE void shape_group(BeamTask<Q, A>& task, int g, unsigned lanes, std::uint32_t item, Test&& test) {
  using F = Simd<float, N, A>;
  BeamRays<A>& beam = task.beam;
  unsigned changed = 0;
  for (int part = 0; part < kBeamGroup; part += N) {
    const unsigned asked = lanes >> part & ((2u << (N - 1)) - 1);
    if (asked == 0) continue;
    const std::size_t at = static_cast<std::size_t>(g * kBeamGroup + part);
    const RayLanes<F> rays = shape_rays<F>(task, at);
    HitLanes<F> hit;
    const unsigned met = test(rays, asked, hit, part);
    if (met == 0) continue;
    changed |= met;
    if constexpr (Q == Query::any)
      block_rays<N>(beam, at, met);
    else
      keep_hits(task.out.hits, beam, rays, at, met, hit, item);
  }
  if (changed != 0) beam.refresh(g);
}

/// Any-hit rays of `g` in `sure` are blocked. Returns those of `rays` that remain to be decided.
template <class A>
OKTETT_INLINE unsigned accept_sure(BeamRays<A>& beam, int g, unsigned rays, unsigned sure) {
  if (sure != 0) {
    block_rays<kBeamGroup>(beam, static_cast<std::size_t>(g) * kBeamGroup, sure);
    beam.refresh(g);
  }
  return rays & ~sure & open_rays(beam, g);
}

/// Decides what a group's rays may have hit before, so that hits of shapes can be compared with it.
template <Query Q, class A>
OKTETT_INLINE void decide_group(BeamTask<Q, A>& task, int g) {
  if (!task.decided || task.unclear.size > 0) decide_unclear(task);
  if constexpr (Q == Query::closest) decide_candidates(task, g);
}

/// Group `g` against primitive `k` of a pool of closed-form shapes.
template <class S, Query Q, class A>
OKTETT_INLINE void closed_group(BeamTask<Q, A>& task, const typename S::Pool& pool, std::uint32_t k, int g,
                                unsigned lanes) {
  using D = Simd<double, kBeamGroup, A>;
  shape_group<kBeamGroup>(
      task, g, lanes, pool.item[k], [&](const auto& rays, unsigned asked, auto& hit, int) {
        return asked & bits(first_root<S>(rays, to_double(rays), S::template broadcast<D>(pool, k), hit));
      });
}

/// Calls meet(g, rays) for each of `groups` with the rays that a filter has left undecided in `lanes`.
template <Query Q, class A, class Meet>
OKTETT_INLINE void each_undecided(BeamTask<Q, A>& task, unsigned groups, const BeamLanes& lanes,
                                  Meet&& meet) {
  for (; groups != 0; groups &= groups - 1) {
    const int g = __builtin_ctz(groups);
    unsigned rays = lanes.maybe[g];
    if (Q == Query::any && rays != 0) rays = accept_sure(task.beam, g, rays, lanes.sure[g]);
    if (rays == 0) continue;
    decide_group(task, g);
    meet(g, rays);
  }
}

/// Groups of a beam against cell `k` of a pool of exact surfaces. `lanes.maybe` are the rays that may meet
/// it.
template <Query Q, class A>
OKTETT_INLINE void exact_groups(BeamTask<Q, A>& task, const BeamView& view, Kind kind, std::uint32_t k,
                                unsigned groups, BeamLanes& lanes) {
  const ExactPoolBase& pool = task.accel.exact_pool(kind);
  const ExactCode<A>& code = exact_code<A>(kind);
  code.filter(pool, k, view, groups, lanes);
  each_undecided(task, groups, lanes, [&](int g, unsigned rays) {
    shape_group<ExactCode<A>::kLanes>(task, g, rays, pool.item_of_cell(k),
                                      [&](const auto& r, unsigned asked, auto& hit, int part) {
                                        if constexpr (Q == Query::any) {
                                          // Rays that start on a surface that they leave.
                                          const unsigned leave = asked & (lanes.leave[g] >> part);
                                          if (leave != 0) asked &= ~code.outside(pool, k, r, leave);
                                          if (asked == 0) return 0u;
                                        }
                                        return code.first(pool, k, r, asked, hit);
                                      });
  });
}

/// Groups of a beam against primitive `k` of a pool of closed-form shapes, likewise.
template <class S, Query Q, class A>
OKTETT_INLINE void closed_groups(BeamTask<Q, A>& task, const typename S::Pool& pool, std::uint32_t k,
                                 unsigned groups, BeamLanes& lanes) {
  if constexpr (std::is_same_v<S, Sphere>) {
    BeamSphere sphere;
    if (sphere.set(pool, k, task.beam)) sphere.filter(task.beam, groups, lanes);
  }
  each_undecided(task, groups, lanes, [&](int g, unsigned rays) { closed_group<S>(task, pool, k, g, rays); });
}

/// Groups of a beam against the shapes of a leaf; `met(g)` are the rays of group `g` that may meet its box.
template <Query Q, class A, class Met>
OKTETT_INLINE void shape_leaf_beam(BeamTask<Q, A>& task, const LeafEntry& leaf, unsigned groups, Met&& met) {
  BeamLanes in_box;
  unsigned kept = 0;
  for (; groups != 0; groups &= groups - 1) {
    const int g = __builtin_ctz(groups);
    const unsigned rays = met(g) & open_rays(task.beam, g);
    in_box.maybe[g] = static_cast<std::uint16_t>(rays), in_box.sure[g] = in_box.leave[g] = 0;
    kept |= static_cast<unsigned>(rays != 0) << g;
  }
  if (kept == 0) return;
  if (is_exact(leaf.kind)) {
    const BeamView view = beam_view(task.beam, Q == Query::any);
    for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k) {
      BeamLanes lanes = in_box;
      exact_groups(task, view, leaf.kind, k, kept, lanes);
    }
    return;
  }
  visit_pool(leaf.kind, task.accel.pools, [&](auto shape, const auto& pool) {
    for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k) {
      BeamLanes lanes = in_box;
      closed_groups<decltype(shape)>(task, pool, k, kept, lanes);
    }
  });
}

// ---- Unbounded planes against a beam. In the plane of the beam the inverse depth at which a ray meets such
// a plane is a linear function of (x, y). Before the tree, it bounds the rays. After the tree, the kernel
// decides for the rays that have met nothing surely nearer. The bounds are derived in docs/numerics.md.

/// The plane n.p = offset as seen from the apex.
struct BeamPlane {
  float c, cx, cy;  ///< the inverse depth is c + cx x + cy y
  float error;      ///< bound on the error of that
  double height;    ///< of the apex over the plane, along n
  bool known;       ///< the apex is so far from the plane that the error is bounded
};

template <class A>
BeamPlane beam_plane(const Plane::Pool& pool, std::uint32_t k, const BeamRays<A>& beam) {
  const auto [n, offset] = Plane::broadcast<double>(pool, k);
  double a[3], at = 0, size = std::fabs(offset);
  for (int i = 0; i < 3; ++i) {
    const double p = beam.apex[i];
    a[i] = n[beam.axis[i]], at += a[i] * p, size += std::fabs(p);
  }
  if (beam.mirrored) a[2] = -a[2];
  const double depth = offset - at;
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
  const auto [n, offset] = Plane::broadcast<D>(pool, k);
  const D height = dot_lanes(n, o) - offset;
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
