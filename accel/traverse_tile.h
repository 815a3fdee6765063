#pragma once
/// \file A tile of rays through the tree: nodes and triangles are culled against the whole tile first, then
/// against its groups of sixteen; decisions are put off until the end.
///
/// The filter tells sure hits from unclear ones. A sure hit that is surely nearer than what a ray holds is
/// only noted; unclear ones go to a list. Each ray's note and the list are decided exactly at the end, with
/// all lanes busy, so that the hits are those of every other traversal, bit by bit.

#include "accel/tile_leaf.h"
#include "accel/traverse_packet.h"

namespace oktett {

struct TileEntry {
  NodeRef ref;
  float near;  ///< greatest inverse depth in the box
  float x_lo, x_hi, y_lo, y_hi;
  unsigned groups;
};

/// Where the boxes of a node's children lie in the plane of a tile.
struct alignas(32) ChildWindows {
  float near[BvhNode::kWidth], x_lo[BvhNode::kWidth], x_hi[BvhNode::kWidth], y_lo[BvhNode::kWidth],
      y_hi[BvhNode::kWidth];
};

/// Children of `node` whose boxes meet the window.
template <class A>
OKTETT_INLINE unsigned node_tile(const BvhNode& node, const TileRays<A>& tile, const TileWindow& w,
                                 ChildWindows& out) {
  using B = Simd<float, BvhNode::kWidth, A>;
  const int kx = 2 * tile.axis[0], ky = 2 * tile.axis[1], kz = 2 * tile.axis[2];
  const B ox(tile.apex[0]), oy(tile.apex[1]), oz(tile.apex[2]);
  const B xl = B::load(node.plane[kx]) - ox, xh = B::load(node.plane[kx + 1]) - ox;
  const B yl = B::load(node.plane[ky]) - oy, yh = B::load(node.plane[ky + 1]) - oy;
  const B z_low = B::load(node.plane[kz]) - oz, z_high = B::load(node.plane[kz + 1]) - oz;
  const B zn = tile.mirrored ? -z_high : z_low, zf = tile.mirrored ? -z_low : z_high;
  const B margin(tile.margin + tile.slip), infinity(std::numeric_limits<float>::infinity());
  // So near the plane of the apex that rounding counts for more than kTileSlack, or behind it.
  const auto front = zn > B(tile.margin * 0x1p20f + 4 * tile.behind);
  const B rn = B(1 + kTileSlack) / zn, rf = B(1 - kTileSlack) / zf, wide = margin * rn;
  const B px_lo = select(front, min(xl * rn, xl * rf) - wide, -infinity);
  const B px_hi = select(front, max(xh * rn, xh * rf) + wide, infinity);
  const B py_lo = select(front, min(yl * rn, yl * rf) - wide, -infinity);
  const B py_hi = select(front, max(yh * rn, yh * rf) + wide, infinity);
  const B near = select(front, rn, infinity);
  auto hit = (zn <= zf) & (px_lo <= B(w.x_hi)) & (B(w.x_lo) <= px_hi) & (py_lo <= B(w.y_hi)) &
             (B(w.y_lo) <= py_hi) & (B(w.least) < near);
  const auto about = hit & ~front;
  if (OKTETT_UNLIKELY(any(about))) {
    // Against the four planes of the window's pyramid, which needs no division.
    const B behind(tile.behind + tile.margin);
    const B zc = max(zn, -behind);
    const auto side = [&](const B& coordinate, float slope) {
      const B bound = B(slope) * (slope > 0 ? zc : zf);
      return coordinate - bound + (abs(coordinate) + abs(bound)) * B(kTileSlack) + (margin + behind) >=
             B(0.0f);
    };
    const auto inside =
        (-behind <= zf) & side(xh, w.x_lo) & side(-xl, -w.x_hi) & side(yh, w.y_lo) & side(-yl, -w.y_hi);
    hit = hit & (front | inside);
  }
  const unsigned children = bits(hit);
  if (children != 0)
    near.store(out.near), px_lo.store(out.x_lo), px_hi.store(out.x_hi), py_lo.store(out.y_lo),
        py_hi.store(out.y_hi);
  return children;
}

/// The groups of `e` that its box may concern.
template <class A>
OKTETT_INLINE unsigned entry_groups(const TileEntry& e, const TileRays<A>& tile) {
  using G = Simd<float, kTileGroups, A>;
  return e.groups & bits((G::load(tile.x_lo) <= G(e.x_hi)) & (G(e.x_lo) <= G::load(tile.x_hi)) &
                         (G::load(tile.y_lo) <= G(e.y_hi)) & (G(e.y_lo) <= G::load(tile.y_hi)) &
                         (G::load(tile.least) < G(e.near)));
}

/// The rays of one group that the box of `e` may concern.
template <class A>
OKTETT_INLINE unsigned entry_rays(const TileEntry& e, const TileRays<A>& tile, int group) {
  using F = Simd<float, kTileGroup, A>;
  const int base = group * kTileGroup;
  const F x = F::load(tile.x + base), y = F::load(tile.y + base);
  return bits((x <= F(e.x_hi)) & (F(e.x_lo) <= x) & (y <= F(e.y_hi)) & (F(e.y_lo) <= y) &
              (F::load(tile.held_lo + base) < F(e.near)));
}

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

/// A triangle whose plane passes by the apex, against the rays of some groups, by the filter that knows no
/// tile.
template <Query Q, class A>
OKTETT_NOINLINE void meet_edge_on(TileTask<Q, A>& task, std::uint32_t id, unsigned groups) {
  using F = Simd<float, kTileGroup, A>;
  const auto tri = filter_triangle(broadcast_triangle<F>(task.accel.blocks[id / TriangleBlock::kSize],
                                                         static_cast<int>(id % TriangleBlock::kSize)));
  for (; groups != 0; groups &= groups - 1) {
    const int g = __builtin_ctz(groups);
    const RayLanes<F> r = load_group(task.tile, task.rays, g);
    const F d_max = max(abs(r.d.x), max(abs(r.d.y), abs(r.d.z)));
    const F infinity(std::numeric_limits<float>::infinity());
    const unsigned open = bits(F::load(task.tile.held_lo + g * kTileGroup) < infinity);
    note_unclear(task, open & bits(filter_watertight(r, d_max, tri)), g, id);
  }
}

template <Query Q, class A>
OKTETT_INLINE void leaf_tile(TileTask<Q, A>& task, NodeRef ref, unsigned groups, const TileWindow& window,
                             unsigned& dirty) {
  TileRays<A>& tile = task.tile;
  ProjectedTriangles<A> projected;
  const BlockCandidates found =
      project_block(task.accel.blocks[ref.block()], ref.triangle_count(), tile, window, projected);
  const std::uint32_t base = ref.block() * TriangleBlock::kSize;
  for (unsigned rest = found.projected; rest != 0; rest &= rest - 1) {
    const int k = __builtin_ctz(rest);
    unsigned met = (groups & (groups - 1)) == 0 ? groups : groups_meeting(projected, k, tile, groups);
    for (; met != 0; met &= met - 1) {
      const int g = __builtin_ctz(met);
      const GroupVerdict verdict =
          meet_group<Q == Query::any>(projected, k, base + static_cast<unsigned>(k), tile, g);
      dirty |= static_cast<unsigned>(verdict.sure != 0) << g;
      if (OKTETT_UNLIKELY(verdict.unclear != 0))
        note_unclear(task, verdict.unclear, g, base + static_cast<unsigned>(k));
    }
  }
  for (unsigned rest = found.edge_on; OKTETT_UNLIKELY(rest != 0); rest &= rest - 1)
    meet_edge_on(task, base + static_cast<unsigned>(__builtin_ctz(rest)), groups);
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

/// A leaf that is not a block of triangles, against the rays of some groups.
template <Query Q, class A>
OKTETT_NOINLINE void table_leaf_tile(TileTask<Q, A>& task, const LeafEntry& leaf, unsigned groups) {
  using F = Simd<float, kTileGroup, A>;
  TileRays<A>& tile = task.tile;
  decide_unclear(task);
  for (; groups != 0; groups &= groups - 1) {
    const int g = __builtin_ctz(groups);
    const std::size_t base = static_cast<std::size_t>(g) * kTileGroup;
    const RayLanes<F> r = load_group(tile, task.rays, g);
    const unsigned open = bits(F::load(tile.held_lo + base) < F(std::numeric_limits<float>::infinity()));
    RayState<kTileGroup, A> state;
    const unsigned lanes = state.set(r.o, r.d, r.tmin, r.tmax, task.accel.bounds) & open;
    if constexpr (Q == Query::closest) {
      decide_held(task, g);
      for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
        const int i = __builtin_ctz(rest);
        const Hit h = (*task.hits)[base + static_cast<std::size_t>(i)];
        if (h.valid())
          state.tmax[i] = h.t, state.u[i] = h.u, state.v[i] = h.v, state.item[i] = h.item,
          state.path[i] = h.instance;
      }
    }
    table_leaf_packet<Q>(task.accel, leaf, state, lanes);
    for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
      const int i = __builtin_ctz(rest);
      if (state.item[i] == kNoId) continue;
      if constexpr (Q == Query::any)
        tile.held_lo[base + static_cast<std::size_t>(i)] = std::numeric_limits<float>::infinity();
      else
        accept_tile(*task.hits, tile, __builtin_fabsf(state.d[tile.axis[2]][i]),
                    base + static_cast<std::size_t>(i), state.hit(i));
    }
    tile.refresh(g);
  }
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

/// Children in the order of their distance, the nearest on top.
OKTETT_INLINE int push_windows(const BvhNode& node, unsigned children, const ChildWindows& w, unsigned groups,
                               TileEntry* stack, int size) {
  const int base = size;
  for (; children != 0; children &= children - 1) {
    const int c = __builtin_ctz(children);
    int at = size++;
    while (at > base && stack[at - 1].near > w.near[c]) stack[at] = stack[at - 1], --at;
    stack[at] = {node.child[c], w.near[c], w.x_lo[c], w.x_hi[c], w.y_lo[c], w.y_hi[c], groups};
  }
  return size;
}

/// Of so few groups, each is asked whether one of its rays is in the box at all.
inline constexpr int kRefinedGroups = 8;

/// False if the tile was given up because it met too many leaves.
template <Query Q, class A>
OKTETT_NOINLINE bool traverse_tile(TileTask<Q, A>& task) {
  const Accel& accel = task.accel;
  TileRays<A>& tile = task.tile;
  TileEntry stack[kStackSize];
  int size = 0, leaves = 0;
  unsigned dirty = 0;  // groups whose least[] is out of date, which is harmless
  stack[size++] = {accel.root,       std::numeric_limits<float>::infinity(),
                   tile.window.x_lo, tile.window.x_hi,
                   tile.window.y_lo, tile.window.y_hi,
                   tile.groups};
  ChildWindows children;
  while (size > 0) {
    const TileEntry e = stack[--size];
    if (__builtin_popcount(dirty) >= 4) {
      for (; dirty != 0; dirty &= dirty - 1) tile.refresh(__builtin_ctz(dirty));
      tile.refresh_window();
    }
    unsigned groups = entry_groups(e, tile);
    if (groups == 0) continue;
    if (e.ref.is_triangles() && __builtin_popcount(groups) <= kRefinedGroups) {
      unsigned kept = 0;
      for (unsigned rest = groups; rest != 0; rest &= rest - 1)
        kept |= static_cast<unsigned>(entry_rays(e, tile, __builtin_ctz(rest)) != 0) << __builtin_ctz(rest);
      groups = kept;
      if (groups == 0) continue;
    }
    TileWindow window = tile.window;
    if ((groups & (groups - 1)) == 0) {
      const int g = __builtin_ctz(groups);
      const unsigned rays = entry_rays(e, tile, g);
      if (rays == 0) continue;
      if ((rays & (rays - 1)) == 0) {
        const int i = g * kTileGroup + __builtin_ctz(rays);
        window = {tile.x[i], tile.x[i], tile.y[i], tile.y[i], tile.held_lo[i], {tile.x[i], tile.y[i]}};
      } else {
        window = group_window(tile, g);
      }
    }
    if (!e.ref.is_leaf()) {
      const BvhNode& node = accel.nodes[e.ref.node_index()];
      const unsigned met = node_tile(node, tile, window, children);
      size = push_windows(node, met, children, groups, stack, size);
    } else if (e.ref.is_triangles()) {
      if (++leaves > task.max_leaves) return false;
      leaf_tile(task, e.ref, groups, window, dirty);
    } else {
      table_leaf_tile(task, accel.leaves[e.ref.table_index()], groups);
      tile.refresh_window();
    }
  }
  return true;
}

enum class TileOutcome {
  traced,
  no_tile,   ///< the rays share no point, fan out too far or are out of scale
  given_up,  ///< they met more leaves than was allowed
};

/// Up to kTileRays rays that meet in `apex`. Unless they are traced, nothing has been written that another
/// traversal would not overwrite.
template <Query Q, class A>
OKTETT_NOINLINE TileOutcome trace_tile(const Accel& accel, const RaySpan& rays, const Apex& apex,
                                       const HitSpan* hits, std::uint8_t* occluded, int max_leaves) {
  TileTask<Q, A> task{accel, rays, hits, occluded, {}, {}, max_leaves};
  if (!task.tile.set(rays, apex, box_extent(accel.bounds), Q == Query::any)) return TileOutcome::no_tile;
  if (task.tile.groups != 0) {
    for (const LeafEntry& leaf : accel.unbounded) table_leaf_tile(task, leaf, task.tile.groups);
    if (!accel.root.is_none() && !traverse_tile(task)) return TileOutcome::given_up;
  }
  finish_tile(task);
  return TileOutcome::traced;
}

}  // namespace oktett
