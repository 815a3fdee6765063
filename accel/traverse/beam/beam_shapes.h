#pragma once
/// \file Closed-form and exact shapes against the groups of a beam: the rays of a group that may meet a shape
/// go to its kernel straight from the columns of the batch.

#include "accel/exact_table.h"
#include "accel/traverse/beam/beam_sphere.h"
#include "accel/traverse/beam/beam_task.h"

namespace oktett {

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
  // At equal distance the numbers of the items decide.
  for (unsigned same = met & bits(h.t == rays.tmax); OKTETT_UNLIKELY(same != 0); same &= same - 1) {
    const std::size_t i = at + static_cast<std::size_t>(__builtin_ctz(same));
    if (hits.item[i] != kNoId && !id_before(kNoId, item, hits.instance[i], hits.item[i]))
      met &= ~(same & -same);
  }
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

}  // namespace oktett
