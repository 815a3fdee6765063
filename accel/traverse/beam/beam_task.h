#pragma once
/// \file The state of a beam on its way through the tree, and the exact decisions of its candidates.

#include <limits>

#include "accel/traverse/beam/beam_leaf.h"
#include "accel/traverse/inflight/decide_pairs.h"

namespace oktett {

/// Pairs of a triangle and a ray that the filter could neither reject nor accept.
struct UnclearList {
  static constexpr int kSize = 512;
  std::uint32_t triangle[kSize + kBeamGroup];  ///< 8 * block + lane
  std::uint8_t ray[kSize + kBeamGroup];
  int size = 0;
};

/// Mailboxes (Amanatides and Woo 1987) for triangles that stand in several leaves: which groups have been
/// tested against a triangle. Another triangle may take over an entry; then the first is tested twice, which
/// does no harm.
class MetTriangles {
 public:
  MetTriangles() { clear(); }
  /// Forgets everything, for groups of other rays.
  void clear() { std::fill_n(item_, kSize, kNoId); }
  /// Notes that `groups` are tested against `item`. Returns those of them that were not before.
  OKTETT_INLINE unsigned add(std::uint32_t item, unsigned groups) {
    const std::uint32_t at = item * 0x9e3779b1u >> 26;
    const unsigned met = item_[at] == item ? groups_[at] : 0;
    item_[at] = item, groups_[at] = met | groups;
    return groups & ~met;
  }

 private:
  static constexpr int kSize = 64;
  std::uint32_t item_[kSize], groups_[kSize];
};

/// BeamTask::max_steps of a beam that is never given up.
inline constexpr int kAnySteps = std::numeric_limits<int>::max();

template <Query Q, class A>
class BeamInstances;

/// A beam, what it has found, and where its results go.
template <Query Q, class A>
struct BeamTask {
  const Accel& accel;
  const RaySpan& rays;
  const HitSink<Q>& out;  ///< complete only when the beam is finished
  BeamRays<A> beam;
  UnclearList unclear;
  int max_steps;                   ///< nodes and leaves that it may visit before it is given up
  BeamInstances<Q, A>* instances;  ///< where there are instances
  MetTriangles met = {};           ///< in use if triangles stand in several leaves
  bool decided = false;            ///< some hits have been decided and stand in `out`
};

/// The rays of group `g` that are not finished: an any-hit ray that is known to be blocked is.
template <class A>
OKTETT_INLINE unsigned open_rays(const BeamRays<A>& beam, int g) {
  using F = Simd<float, kBeamGroup, A>;
  return bits(F::load(beam.hit_lo + g * kBeamGroup) < F(std::numeric_limits<float>::infinity()));
}

/// Notes that the any-hit rays [at, at + N) in `lanes` are blocked.
template <int N, class A>
OKTETT_INLINE void block_rays(BeamRays<A>& beam, std::size_t at, unsigned lanes) {
  using F = Simd<float, N, A>;
  const F infinity(std::numeric_limits<float>::infinity());
  select(F::M::from_bits(lanes), infinity, F::load(beam.hit_lo + at)).store(beam.hit_lo + at);
}

/// Stores the decided hit `h` of ray i if it is the nearest so far. `dz`: the |direction| of the ray along z.
template <class A>
OKTETT_INLINE void accept_beam(const HitSpan& hits, BeamRays<A>& beam, float dz, std::size_t i,
                               const Hit& h) {
  if (h.t > hits.t[i]) return;
  if (h.t == hits.t[i] && hits.item[i] != kNoId &&
      !id_before(h.instance, h.item, hits.instance[i], hits.item[i]))
    return;
  hits.set(i, h);
  const float s = 1 / (h.t * dz);
  const float lo = s * (1 - kBeamPointSlack), hi = s * (1 + kBeamPointSlack);
  beam.hit_lo[i] = lo > beam.hit_lo[i] ? lo : beam.hit_lo[i];
  beam.hit_hi[i] = hi > beam.hit_hi[i] ? hi : beam.hit_hi[i];
}

/// Loads the decided hits of a group into `r`, so that hits of other shapes are compared with them.
template <class A>
OKTETT_INLINE void load_hits(const HitSpan& hits, std::size_t base, RayState<kBeamGroup, A>& r) {
  for (std::size_t i = 0; i < kBeamGroup && base + i < hits.size; ++i) {
    if (hits.item[base + i] == kNoId) continue;
    r.tmax[i] = hits.t[base + i], r.u[i] = hits.u[base + i], r.v[i] = hits.v[base + i];
    r.item[i] = hits.item[base + i], r.path[i] = hits.instance[base + i];
  }
}

/// Stores the hits `h` of the rays [at, at + width) in `met`. `dz`: their directions along z.
template <class F, class I, class A>
OKTETT_INLINE void store_hits(const HitSpan& hits, BeamRays<A>& beam, const F& dz, std::size_t at,
                              unsigned met, const HitLanes<F>& h, const I& item, const I& instance) {
  const auto found = F::M::from_bits(met);
  if (at + F::kWidth <= hits.size) {
    const auto put = [&](const F& x, float* to) { select(found, x, F::load(to + at)).store(to + at); };
    const auto put_ids = [&](const I& ids, std::uint32_t* column) {
      auto* to = reinterpret_cast<std::int32_t*>(column + at);
      select(mask_cast<std::int32_t>(found), ids, I::load(to)).store(to);
    };
    put(h.t, hits.t), put(h.u, hits.u), put(h.v, hits.v);
    put_ids(item, hits.item), put_ids(instance, hits.instance);
  } else {
    alignas(64) float t[F::kWidth], u[F::kWidth], v[F::kWidth];
    alignas(64) std::int32_t items[F::kWidth], instances[F::kWidth];
    h.t.store(t), h.u.store(u), h.v.store(v), item.store(items), instance.store(instances);
    for (unsigned rest = met; rest != 0; rest &= rest - 1) {
      const int i = __builtin_ctz(rest);
      hits.set(at + static_cast<std::size_t>(i), {t[i], u[i], v[i], static_cast<std::uint32_t>(items[i]),
                                                  static_cast<std::uint32_t>(instances[i])});
    }
  }
  const F s = F(1.0f) / (h.t * abs(dz));
  const auto raise = [&](float* column, float slack) {
    const F was = F::load(column + at);
    select(found, max(s * F(slack), was), was).store(column + at);
  };
  raise(beam.hit_lo, 1 - kBeamPointSlack), raise(beam.hit_hi, 1 + kBeamPointSlack);
}

/// The same for the hits of `r`.
template <class A>
OKTETT_INLINE void store_hits(const HitSpan& hits, BeamRays<A>& beam, std::size_t base, unsigned met,
                              const RayState<kBeamGroup, A>& r) {
  using F = Simd<float, kBeamGroup, A>;
  const auto ids = [](const std::uint32_t* from) {
    return Simd<std::int32_t, kBeamGroup, A>::load(reinterpret_cast<const std::int32_t*>(from));
  };
  const HitLanes<F> h{F::load(r.tmax), F::load(r.u), F::load(r.v)};
  store_hits(hits, beam, F::load(r.d[beam.axis[2]]), base, met, h, ids(r.item), ids(r.path));
}

/// Sixteen misses from position `base`.
template <class A>
OKTETT_INLINE void store_misses(const HitSpan& hits, std::size_t base) {
  using F = Simd<float, kBeamGroup, A>;
  const F zero(0.0f);
  F(std::numeric_limits<float>::infinity()).store(hits.t + base);
  zero.store(hits.u + base), zero.store(hits.v + base);
  std::memset(hits.item + base, 0xff, kBeamGroup * sizeof(std::uint32_t));
  std::memset(hits.instance + base, 0xff, kBeamGroup * sizeof(std::uint32_t));
}

/// Before the first decision: stores a miss for every ray.
template <Query Q, class A>
OKTETT_INLINE void begin_decisions(BeamTask<Q, A>& task) {
  if constexpr (Q == Query::closest) {
    if (task.decided) return;
    task.decided = true;
    std::size_t i = 0;
    for (; i + kBeamGroup <= task.rays.size; i += kBeamGroup) store_misses<A>(task.out.hits, i);
    for (; i < task.rays.size; ++i) task.out.set(i, Hit{});
  }
}

/// Decides `count` (up to 16) pairs of a ray and a triangle.
template <Query Q, class A>
OKTETT_NOINLINE void decide_listed(BeamTask<Q, A>& task, const std::uint8_t* ray,
                                   const std::uint32_t* triangle, int count) {
  using F = Simd<float, kBeamGroup, A>;
  alignas(64) float column[8][kBeamGroup];
  std::uint32_t ids[kBeamGroup];
  for (int i = 0; i < kBeamGroup; ++i) {
    const int k = i < count ? i : 0;
    const Ray r = task.rays[task.beam.sorted ? task.beam.order[ray[k]] : ray[k]];
    const float values[8] = {r.origin.x,    r.origin.y,    r.origin.z, r.direction.x,
                             r.direction.y, r.direction.z, r.tmin,     r.tmax};
    for (int c = 0; c < 8; ++c) column[c][i] = values[c];
    ids[i] = triangle[k];
  }
  const auto load = [&](int c) { return F::load(column[c]); };
  const RayLanes<F> rays{{load(0), load(1), load(2)}, {load(3), load(4), load(5)}, load(6), load(7)};
  HitLanes<F> hit;
  unsigned met = decide_pairs<kBeamGroup, A>(rays, task.accel.blocks.data(), ids, hit) & ((1u << count) - 1);
  if (met == 0) return;
  alignas(64) float t[kBeamGroup], u[kBeamGroup], v[kBeamGroup];
  hit.t.store(t), hit.u.store(u), hit.v.store(v);
  for (; met != 0; met &= met - 1) {
    const int i = __builtin_ctz(met);
    if constexpr (Q == Query::any) {
      task.beam.hit_lo[ray[i]] = std::numeric_limits<float>::infinity();
    } else {
      const std::uint32_t item =
          task.accel.blocks[ids[i] / TriangleBlock::kSize].item[ids[i] % TriangleBlock::kSize];
      accept_beam(task.out.hits, task.beam, __builtin_fabsf(column[3 + task.beam.axis[2]][i]), ray[i],
                  {t[i], u[i], v[i], item, kNoId});
    }
  }
}

/// Decides the list of unclear candidates.
template <Query Q, class A>
OKTETT_NOINLINE void decide_unclear(BeamTask<Q, A>& task) {
  begin_decisions(task);
  UnclearList& list = task.unclear;
  for (int i = 0; i < list.size; i += kBeamGroup) {
    if (Q == Query::any) {
      // Rays that are known to be occluded need no decision.
      int kept = 0;
      const int end = std::min(list.size, i + kBeamGroup);
      for (int k = i; k < end; ++k) {
        if (task.beam.hit_lo[list.ray[k]] == std::numeric_limits<float>::infinity()) continue;
        list.ray[i + kept] = list.ray[k], list.triangle[i + kept] = list.triangle[k], ++kept;
      }
      if (kept > 0) decide_listed(task, list.ray + i, list.triangle + i, kept);
    } else {
      decide_listed(task, list.ray + i, list.triangle + i, std::min(list.size - i, kBeamGroup));
    }
  }
  list.size = 0;
}

/// Lists `rays` of a group as unclear against triangle `id`. Decides the list when it is full.
template <Query Q, class A>
OKTETT_INLINE void note_unclear(BeamTask<Q, A>& task, unsigned rays, int group, std::uint32_t id) {
  UnclearList& list = task.unclear;
  for (; rays != 0; rays &= rays - 1) {
    list.ray[list.size] = static_cast<std::uint8_t>(group * kBeamGroup + __builtin_ctz(rays));
    list.triangle[list.size++] = id;
  }
  if (OKTETT_UNLIKELY(list.size >= UnclearList::kSize)) decide_unclear(task);
}

/// Decides the candidates of a group, so that hits of other shapes can be compared with them.
template <Query Q, class A>
OKTETT_NOINLINE void decide_candidates(BeamTask<Q, A>& task, int group) {
  if (task.accel.blocks.data() == nullptr) return;  // without triangles there are no candidates
  std::uint8_t ray[kBeamGroup];
  std::uint32_t ids[kBeamGroup];
  int count = 0;
  for (int i = group * kBeamGroup; i < (group + 1) * kBeamGroup; ++i) {
    if (task.beam.candidate[i] == kNoId) continue;
    ray[count] = static_cast<std::uint8_t>(i), ids[count++] = task.beam.candidate[i];
    task.beam.candidate[i] = kNoId;
  }
  if (count > 0) decide_listed(task, ray, ids, count);
}

/// Decides the candidates of a whole group and stores the hits.
template <class A>
OKTETT_INLINE void finish_group(BeamTask<Query::closest, A>& task, std::size_t base) {
  using F = Simd<float, kBeamGroup, A>;
  using I = Simd<std::int32_t, kBeamGroup, A>;
  constexpr std::uint32_t kSize = TriangleBlock::kSize;
  const HitSpan& hits = task.out.hits;
  const std::uint32_t* candidates = task.beam.candidate + base;
  const TriangleBlock* blocks = task.accel.blocks.data();
  const auto as_int = [](auto* p) { return reinterpret_cast<std::int32_t*>(p); };
  const I notes = I::load(reinterpret_cast<const std::int32_t*>(candidates)), nothing(-1);
  const auto none = notes == nothing;
  const unsigned missing = bits(none);
  if (missing == (1u << kBeamGroup) - 1) return store_misses<A>(hits, base);
  const std::uint32_t some = candidates[__builtin_ctz(~missing)];
  alignas(64) std::uint32_t ids[kBeamGroup];
  select(none, I(static_cast<std::int32_t>(some)), notes).store(as_int(ids));
  HitLanes<F> h;
  decide_pairs<kBeamGroup, A>(load_span<F>(task.rays, base), blocks, ids, h);
  const auto miss = F::M::from_bits(missing);
  const F zero(0.0f);
  select(miss, F(std::numeric_limits<float>::infinity()), h.t).store(hits.t + base);
  select(miss, zero, h.u).store(hits.u + base), select(miss, zero, h.v).store(hits.v + base);
  alignas(64) std::uint32_t items[kBeamGroup];
  for (int i = 0; i < kBeamGroup; ++i) items[i] = blocks[ids[i] / kSize].item[ids[i] % kSize];
  select(none, nothing, I::load(as_int(items))).store(as_int(hits.item + base));
  std::memset(hits.instance + base, 0xff, kBeamGroup * sizeof(std::uint32_t));
}

/// Writes the results of a finished beam.
template <class A>
OKTETT_INLINE void finish_beam(BeamTask<Query::closest, A>& task) {
  const std::size_t whole = task.decided ? 0 : task.rays.size / kBeamGroup * kBeamGroup;
  for (std::size_t base = 0; base < whole; base += kBeamGroup) finish_group(task, base);
  if (!task.decided)
    for (std::size_t i = whole; i < task.rays.size; ++i) task.out.set(i, Hit{});
  task.decided = true;
  for (std::size_t base = whole; base < task.rays.size; base += kBeamGroup)
    decide_candidates(task, static_cast<int>(base / kBeamGroup));
  if (task.unclear.size > 0) decide_unclear(task);
}

template <class A>
OKTETT_INLINE void finish_beam(BeamTask<Query::any, A>& task) {
  if (task.unclear.size > 0) decide_unclear(task);
  const BeamRays<A>& beam = task.beam;
  using F = Simd<float, kBeamGroup, A>;
  const F infinity(std::numeric_limits<float>::infinity());
  std::uint8_t found[kBeamRays];
  for (int base = 0; base < kBeamRays; base += kBeamGroup) {
    // Rays that could not hit anything from the start have no end either.
    const unsigned done =
        bits((F::load(beam.hit_lo + base) == infinity) & (F::load(beam.hit_hi + base) < infinity));
    for (int i = 0; i < kBeamGroup; ++i) found[base + i] = static_cast<std::uint8_t>(done >> i & 1);
  }
  if (beam.sorted) {
    for (int i = 0; i < kBeamRays; ++i) task.out.occluded[beam.order[i]] = found[i];
  } else {
    std::memcpy(task.out.occluded, found, task.rays.size);
  }
}

}  // namespace oktett
