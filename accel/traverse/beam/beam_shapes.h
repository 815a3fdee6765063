#pragma once
/// \file Closed-form and exact shapes against the groups of a beam: the rays of a group that may meet a shape
/// go to its kernel straight from the columns of the batch.

#include "accel/exact_table.h"
#include "accel/traverse/beam/beam_task.h"

namespace oktett {

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
  constexpr int N = F::kWidth;
  using I = Simd<std::int32_t, N, A>;
  // At equal distance the numbers of the items decide.
  for (unsigned same = met & bits(h.t == rays.tmax); OKTETT_UNLIKELY(same != 0); same &= same - 1) {
    const std::size_t i = at + static_cast<std::size_t>(__builtin_ctz(same));
    if (hits.item[i] != kNoId && !id_before(kNoId, item, hits.instance[i], hits.item[i]))
      met &= ~(same & -same);
  }
  if (met == 0) return;
  const auto found = F::M::from_bits(met);
  if (at + N <= hits.size) {
    const auto put = [&](const F& x, float* to) { select(found, x, F::load(to + at)).store(to + at); };
    const auto put_id = [&](std::uint32_t id, std::uint32_t* column) {
      auto* to = reinterpret_cast<std::int32_t*>(column + at);
      select(mask_cast<std::int32_t>(found), I(static_cast<std::int32_t>(id)), I::load(to)).store(to);
    };
    put(h.t, hits.t), put(h.u, hits.u), put(h.v, hits.v);
    put_id(item, hits.item), put_id(kNoId, hits.instance);
  } else {
    alignas(64) float t[N], u[N], v[N];
    h.t.store(t), h.u.store(u), h.v.store(v);
    for (unsigned rest = met; rest != 0; rest &= rest - 1) {
      const int i = __builtin_ctz(rest);
      hits.set(at + static_cast<std::size_t>(i), {t[i], u[i], v[i], item, kNoId});
    }
  }
  const F* d[3] = {&rays.d.x, &rays.d.y, &rays.d.z};
  const F s = F(1.0f) / (h.t * abs(*d[beam.axis[2]]));
  const auto raise = [&](float* column, float slack) {
    const F was = F::load(column + at);
    select(found, max(s * F(slack), was), was).store(column + at);
  };
  raise(beam.hit_lo, 1 - kBeamPointSlack), raise(beam.hit_hi, 1 + kBeamPointSlack);
}

/// The rays in `lanes` of group `g` against one shape, N at once. `test(rays, lanes, hit)` is the shape's
/// kernel and returns the lanes that are hit.
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
    const unsigned met = test(rays, asked, hit);
    if (met == 0) continue;
    changed |= met;
    if constexpr (Q == Query::any) {
      const F infinity(std::numeric_limits<float>::infinity());
      select(F::M::from_bits(met), infinity, F::load(beam.hit_lo + at)).store(beam.hit_lo + at);
    } else {
      keep_hits(task.out.hits, beam, rays, at, met, hit, item);
    }
  }
  if (changed != 0) beam.refresh(g);
}

/// The rays of `g` that are not finished: an any-hit ray that is known to be blocked is.
template <class A>
OKTETT_INLINE unsigned open_rays(const BeamRays<A>& beam, int g) {
  using F = Simd<float, kBeamGroup, A>;
  return bits(F::load(beam.hit_lo + g * kBeamGroup) < F(std::numeric_limits<float>::infinity()));
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
  shape_group<kBeamGroup>(task, g, lanes, pool.item[k], [&](const auto& rays, unsigned asked, auto& hit) {
    return asked & bits(first_root<S>(rays, to_double(rays), S::template broadcast<D>(pool, k), hit));
  });
}

/// Groups of a beam against the shapes of a leaf; `met(g)` are the rays of group `g` that may meet its box.
template <Query Q, class A, class Met>
OKTETT_INLINE void shape_leaf_beam(BeamTask<Q, A>& task, const LeafEntry& leaf, unsigned groups, Met&& met) {
  for (; groups != 0; groups &= groups - 1) {
    const int g = __builtin_ctz(groups);
    const unsigned rays = met(g) & open_rays(task.beam, g);
    if (rays == 0) continue;
    decide_group(task, g);
    if (is_exact(leaf.kind)) {
      const ExactPoolBase& pool = task.accel.exact_pool(leaf.kind);
      const auto first = exact_code<A>(leaf.kind).first;
      for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k)
        shape_group<ExactCode<A>::kLanes>(
            task, g, rays, pool.item_of_cell(k),
            [&](const auto& r, unsigned asked, auto& hit) { return first(pool, k, r, asked, hit); });
    } else {
      visit_pool(leaf.kind, task.accel.pools, [&](auto shape, const auto& pool) {
        for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k)
          closed_group<decltype(shape)>(task, pool, k, g, rays & open_rays(task.beam, g));
      });
    }
  }
}

}  // namespace oktett
