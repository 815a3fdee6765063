#pragma once
/// \file A tile at work: what its rays hold, what is unclear, and the decisions at the end.

#include "accel/tile_leaf.h"

namespace oktett {

/// Candidates that the filter could not tell.
struct UnclearList {
  static constexpr int kSize = 512;
  std::uint32_t triangle[kSize + kTileGroup];  ///< 8 * block + lane
  std::uint8_t ray[kSize + kTileGroup];
  int size = 0;
};

/// A tile on its way through the tree, and where its results go.
template <Query Q, class A>
struct TileTask {
  const Accel& accel;
  const RaySpan& rays;
  const HitSpan* hits;     ///< for Query::closest; complete only when the tile is finished
  std::uint8_t* occluded;  ///< for Query::any
  TileRays<A> tile;
  UnclearList unclear;
  int max_leaves;        ///< blocks to meet before the tile is given up
  bool decided = false;  ///< some hits have been decided and stand in `hits`
};

/// Gathers the triangles `ids` (8 * block + lane) into lanes.
template <int N, class A>
OKTETT_INLINE TriangleLanes<Simd<float, N, A>> gather_triangles(const TriangleBlock* blocks,
                                                                const std::uint32_t* ids) {
  using F = Simd<float, N, A>;
  constexpr std::uint32_t kSize = TriangleBlock::kSize;
  alignas(64) float v[9][N];
  for (int i = 0; i < N; ++i) {
    const float* p = &blocks[ids[i] / kSize].v[0][0][ids[i] % kSize];
    for (int k = 0; k < 9; ++k) v[k][i] = p[k * kSize];
  }
  const auto corner = [&](int k) {
    return Vec3<F>{F::load(v[3 * k]), F::load(v[3 * k + 1]), F::load(v[3 * k + 2])};
  };
  return {corner(0), corner(1), corner(2)};
}

/// Ray i against triangle ids[i] for all lanes: the decision of decide_watertight, whatever the axes along
/// which the rays are steepest.
template <int N, class A>
OKTETT_INLINE unsigned decide_gathered(RayLanes<Simd<float, N, A>> ray, const TriangleBlock* blocks,
                                       const std::uint32_t* ids, HitLanes<Simd<float, N, A>>& hit) {
  using F = Simd<float, N, A>;
  using D = Simd<double, N, A>;
  TriangleLanes<F> tri = gather_triangles<N, A>(blocks, ids);
  ray.d = flush_direction(ray.d);
  const F ax = abs(ray.d.x), ay = abs(ray.d.y), az = abs(ray.d.z);
  const auto zx = (ax >= ay) & (ax >= az), zy = ~zx & (ay >= az);
  const unsigned along_x = bits(zx), along_y = bits(zy), all = bits(F::M::all_true());
  const auto permute = [&](const Vec3<F>& p) {
    if (along_x == all) return permute_to_z(p, 0);
    if (along_y == all) return permute_to_z(p, 1);
    if ((along_x | along_y) == 0) return p;
    const auto pick = [&](const F& x, const F& y, const F& z) { return select(zx, x, select(zy, y, z)); };
    return Vec3<F>{pick(p.y, p.z, p.x), pick(p.z, p.x, p.y), pick(p.x, p.y, p.z)};
  };
  const Vec3<D> d = to_double(permute(ray.d));
  const D inv_dz = D(1.0) / d.z;
  const ShearLanes<D> shear{to_double(permute(ray.o)), inv_dz, d.x * inv_dz, d.y * inv_dz};
  tri = {permute(tri.a), permute(tri.b), permute(tri.c)};
  return bits(decide_watertight(shear, tri, ray.tmin, ray.tmax, hit));
}

/// Lets a decided hit of ray i count.
template <class A>
OKTETT_INLINE void accept_tile(const HitSpan& hits, TileRays<A>& tile, float dz, std::size_t i,
                               const Hit& h) {
  if (h.t > hits.t[i]) return;
  if (h.t == hits.t[i] && hits.item[i] != kNoId &&
      !id_before(h.instance, h.item, hits.instance[i], hits.item[i]))
    return;
  hits.set(i, h);
  const float s = 1 / (h.t * dz);
  const float lo = s * (1 - kTilePointSlack), hi = s * (1 + kTilePointSlack);
  tile.held_lo[i] = lo > tile.held_lo[i] ? lo : tile.held_lo[i];
  tile.held_hi[i] = hi > tile.held_hi[i] ? hi : tile.held_hi[i];
}

/// Before the first decision, all rays have hit nothing.
template <Query Q, class A>
OKTETT_INLINE void begin_decisions(TileTask<Q, A>& task) {
  if (Q == Query::any || task.decided) return;
  task.decided = true;
  for (std::size_t i = 0; i < task.rays.size; ++i) task.hits->set(i, Hit{});
}

/// Decides `count` (up to 16) pairs.
template <Query Q, class A>
OKTETT_NOINLINE void decide_listed(TileTask<Q, A>& task, const std::uint8_t* ray,
                                   const std::uint32_t* triangle, int count) {
  using F = Simd<float, kTileGroup, A>;
  alignas(64) float column[8][kTileGroup];
  std::uint32_t ids[kTileGroup];
  for (int i = 0; i < kTileGroup; ++i) {
    const int k = i < count ? i : 0;
    const Ray r = task.rays[task.tile.sorted ? task.tile.order[ray[k]] : ray[k]];
    const float values[8] = {r.origin.x,    r.origin.y,    r.origin.z, r.direction.x,
                             r.direction.y, r.direction.z, r.tmin,     r.tmax};
    for (int c = 0; c < 8; ++c) column[c][i] = values[c];
    ids[i] = triangle[k];
  }
  const auto load = [&](int c) { return F::load(column[c]); };
  const RayLanes<F> rays{{load(0), load(1), load(2)}, {load(3), load(4), load(5)}, load(6), load(7)};
  HitLanes<F> hit;
  unsigned met =
      decide_gathered<kTileGroup, A>(rays, task.accel.blocks.data(), ids, hit) & ((1u << count) - 1);
  if (met == 0) return;
  alignas(64) float t[kTileGroup], u[kTileGroup], v[kTileGroup];
  hit.t.store(t), hit.u.store(u), hit.v.store(v);
  for (; met != 0; met &= met - 1) {
    const int i = __builtin_ctz(met);
    if constexpr (Q == Query::any) {
      task.tile.held_lo[ray[i]] = std::numeric_limits<float>::infinity();
    } else {
      const std::uint32_t item =
          task.accel.blocks[ids[i] / TriangleBlock::kSize].item[ids[i] % TriangleBlock::kSize];
      accept_tile(*task.hits, task.tile, __builtin_fabsf(column[3 + task.tile.axis[2]][i]), ray[i],
                  {t[i], u[i], v[i], item, kNoId});
    }
  }
}

/// Decides the list of unclear candidates.
template <Query Q, class A>
OKTETT_NOINLINE void decide_unclear(TileTask<Q, A>& task) {
  begin_decisions(task);
  UnclearList& list = task.unclear;
  for (int i = 0; i < list.size; i += kTileGroup) {
    if (Q == Query::any) {
      // Rays that are known to be occluded need no decision.
      int kept = 0;
      const int end = std::min(list.size, i + kTileGroup);
      for (int k = i; k < end; ++k) {
        if (task.tile.held_lo[list.ray[k]] == std::numeric_limits<float>::infinity()) continue;
        list.ray[i + kept] = list.ray[k], list.triangle[i + kept] = list.triangle[k], ++kept;
      }
      if (kept > 0) decide_listed(task, list.ray + i, list.triangle + i, kept);
    } else {
      decide_listed(task, list.ray + i, list.triangle + i, std::min(list.size - i, kTileGroup));
    }
  }
  list.size = 0;
}

template <Query Q, class A>
OKTETT_INLINE void note_unclear(TileTask<Q, A>& task, unsigned rays, int group, std::uint32_t id) {
  UnclearList& list = task.unclear;
  for (; rays != 0; rays &= rays - 1) {
    list.ray[list.size] = static_cast<std::uint8_t>(group * kTileGroup + __builtin_ctz(rays));
    list.triangle[list.size++] = id;
  }
  if (OKTETT_UNLIKELY(list.size >= UnclearList::kSize)) decide_unclear(task);
}

/// Decides what the rays of a group hold, so that other shapes can be compared with it.
template <Query Q, class A>
OKTETT_NOINLINE void decide_held(TileTask<Q, A>& task, int group) {
  std::uint8_t ray[kTileGroup];
  std::uint32_t ids[kTileGroup];
  int count = 0;
  for (int i = group * kTileGroup; i < (group + 1) * kTileGroup; ++i) {
    if (task.tile.held[i] == kNoId) continue;
    ray[count] = static_cast<std::uint8_t>(i), ids[count++] = task.tile.held[i];
    task.tile.held[i] = kNoId;
  }
  if (count > 0) decide_listed(task, ray, ids, count);
}

/// Sixteen misses from position `base`.
template <class A>
OKTETT_INLINE void store_misses(const HitSpan& hits, std::size_t base) {
  using F = Simd<float, kTileGroup, A>;
  const F zero(0.0f);
  F(std::numeric_limits<float>::infinity()).store(hits.t + base);
  zero.store(hits.u + base), zero.store(hits.v + base);
  std::memset(hits.item + base, 0xff, kTileGroup * sizeof(std::uint32_t));
  std::memset(hits.instance + base, 0xff, kTileGroup * sizeof(std::uint32_t));
}

/// Decides what the rays of a whole group hold and writes it.
template <class A>
OKTETT_INLINE void finish_group(TileTask<Query::closest, A>& task, std::size_t base) {
  using F = Simd<float, kTileGroup, A>;
  const HitSpan& hits = *task.hits;
  const std::uint32_t* held = task.tile.held + base;
  std::uint32_t ids[kTileGroup], some = kNoId;
  unsigned none = 0;
  for (int i = 0; i < kTileGroup; ++i) {
    const bool is_none = held[i] == kNoId;
    none |= static_cast<unsigned>(is_none) << i;
    some = is_none ? some : held[i];
  }
  if (some == kNoId) return store_misses<A>(hits, base);
  for (int i = 0; i < kTileGroup; ++i) ids[i] = held[i] == kNoId ? some : held[i];
  HitLanes<F> h;
  decide_gathered<kTileGroup, A>(load_span<F>(task.rays, base), task.accel.blocks.data(), ids, h);
  const auto miss = F::M::from_bits(none);
  const F zero(0.0f);
  select(miss, F(std::numeric_limits<float>::infinity()), h.t).store(hits.t + base);
  select(miss, zero, h.u).store(hits.u + base), select(miss, zero, h.v).store(hits.v + base);
  for (int i = 0; i < kTileGroup; ++i) {
    const std::uint32_t item =
        task.accel.blocks[ids[i] / TriangleBlock::kSize].item[ids[i] % TriangleBlock::kSize];
    hits.item[base + i] = held[i] == kNoId ? kNoId : item;
  }
  std::memset(hits.instance + base, 0xff, kTileGroup * sizeof(std::uint32_t));
}

/// Writes the results of a finished tile.
template <class A>
OKTETT_INLINE void finish_tile(TileTask<Query::closest, A>& task) {
  const std::size_t whole = task.decided ? 0 : task.rays.size / kTileGroup * kTileGroup;
  for (std::size_t base = 0; base < whole; base += kTileGroup) finish_group(task, base);
  if (!task.decided)
    for (std::size_t i = whole; i < task.rays.size; ++i) task.hits->set(i, Hit{});
  task.decided = true;
  for (std::size_t base = whole; base < task.rays.size; base += kTileGroup)
    decide_held(task, static_cast<int>(base / kTileGroup));
  if (task.unclear.size > 0) decide_unclear(task);
}

template <class A>
OKTETT_INLINE void finish_tile(TileTask<Query::any, A>& task) {
  if (task.unclear.size > 0) decide_unclear(task);
  const TileRays<A>& tile = task.tile;
  using F = Simd<float, kTileGroup, A>;
  const F infinity(std::numeric_limits<float>::infinity());
  std::uint8_t found[kTileRays];
  for (int base = 0; base < kTileRays; base += kTileGroup) {
    // Rays that could not hit anything from the start have no end either.
    const unsigned done =
        bits((F::load(tile.held_lo + base) == infinity) & (F::load(tile.held_hi + base) < infinity));
    for (int i = 0; i < kTileGroup; ++i) found[base + i] = static_cast<std::uint8_t>(done >> i & 1);
  }
  if (tile.sorted) {
    for (int i = 0; i < kTileRays; ++i) task.occluded[tile.order[i]] = found[i];
  } else {
    std::memcpy(task.occluded, found, task.rays.size);
  }
}

}  // namespace oktett
