#pragma once
/// \file Several rays at once against a combination of primitives: their crossings are gathered in lanes and
/// swept in lanes. The hits have the same bits as those of accel/csg/csg_sweep.cpp.

#include <algorithm>

#include "accel/csg/csg.h"
#include "accel/exact_table.h"
#include "accel/ray_state.h"
#include "accel/traverse/node_boxes.h"

namespace oktett {

// ---- Several rays at once against a combination of primitives.

/// In trees of at most this many leaves all leaves are visited, without a look at the nodes.
inline constexpr std::size_t kAllCsgLeaves = 6;

/// Up to N rays through one combination.
template <class A>
class CsgLanes {
 public:
  static constexpr int N = ExactCode<A>::kLanes;
  using F = Simd<float, N, A>;
  using D = Simd<double, N, A>;
  using I = Simd<std::int32_t, N, A>;

  /// The first crossings of the combination by the rays in `lanes`.
  struct Found {
    alignas(64) float t[N];
    alignas(64) std::int32_t row[N];
    unsigned lanes = 0, flipped = 0;
  };

  template <int W>
  OKTETT_INLINE CsgLanes(const CsgItem& csg, const RayState<W, A>& r, int base, unsigned lanes)
      : csg_(csg), lanes_(lanes) {
    const auto load = [&](const float* column) { return load_part<N, W, A>(column, base); };
    rays_ = load_part<N>(r, base);
    inv_ = {load(r.inv[0]), load(r.inv[1]), load(r.inv[2])};
    slab_slack_ = load(r.slack);
  }

  /// Finds the first crossings. False if there are too many crossings or the expression is too large.
  OKTETT_NOINLINE bool first(Found& found) { return gather() && sweep(found); }

  /// Drops the rays that are never inside of one of the probes; returns those that are left.
  OKTETT_NOINLINE unsigned probe() {
    doubles_ = to_double(rays_);
    for (const CsgProbe& probe : csg_.probes)
      if (!gather_leaf(probe.leaf, lanes_, probe.unbounded)) break;
    return lanes_;
  }

  /// Appends the crossings of each ray with all solids, in any order.
  OKTETT_NOINLINE void list(const RayLists<N>& out) const {
    const Accel& solids = *csg_.solids;
    const auto list_leaf = [&](const LeafEntry& leaf, unsigned lanes) {
      for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k)
        if (is_exact(leaf.kind))
          exact_code<A>(leaf.kind).lists(solids.exact_pool(leaf.kind), k, rays_, lanes, out);
        else
          list_shape(leaf.kind, k, lanes, out);
      return true;
    };
    for (const LeafEntry& leaf : solids.unbounded) list_leaf(leaf, lanes_);
    // Of an inside there may be no cell, but of its end.
    walk(F(std::numeric_limits<float>::infinity()), list_leaf);
  }

  const CrossingLanes<N>& rows() const { return rows_; }

 private:
  /// Gathers the crossings with all solids. False if there are too many.
  bool gather() {
    const Accel& solids = *csg_.solids;
    doubles_ = to_double(rays_);
    for (const LeafEntry& leaf : solids.unbounded)
      if (!gather_leaf(leaf, lanes_, true)) return false;
    if (solids.leaves.size() <= kAllCsgLeaves) {
      for (const std::uint32_t leaf : csg_.leaf_order)
        if (!gather_leaf(solids.leaves[leaf], lanes_, false)) return false;
      return true;
    }
    // A solid beyond the end of a ray has no effect on the crossings before it.
    return walk(rays_.tmax, [&](const LeafEntry& leaf, unsigned lanes) {
      return gather_leaf(leaf, lanes & lanes_, false);
    });
  }

  /// Sweeps the crossings from near to far until each ray enters or leaves the combination, or ends. False if
  /// the expression is too large.
  OKTETT_INLINE bool sweep(Found& found) {
    if (rows_.rows == 0 || lanes_ == 0) return true;
    const std::vector<CsgStep>& steps = csg_.steps.empty() ? csg_steps(csg_, operand_, solids_) : csg_.steps;
    if (steps.size() > kMaxPlaces) return false;
    const F inf(std::numeric_limits<float>::infinity()), biggest(std::numeric_limits<float>::max());
    const F slack = coincidence_slack();
    const F last = min(rays_.tmax, biggest);
    F limit(-1.0f), next = inf;
    for (int row = 0; row < rows_.rows; ++row) next = min(F::load(rows_.t[row]), next);
    unsigned inside = evaluate(steps, inside_);
    for (unsigned active = lanes_;;) {
      active &= bits(next <= last);
      if (active == 0) return true;
      const F end = min(next + (next * F(0x1p-21f) + slack), biggest);
      const F after = advance(limit, end);
      const unsigned now = evaluate(steps, inside_);
      const unsigned turned = (now ^ inside) & active;
      if (turned != 0) active &= ~resolve(steps, limit, end, next, turned, now, found);
      inside = now, limit = end, next = after;
    }
  }

  OKTETT_INLINE F coincidence_slack() const {
    const Box& box = csg_.solids->bounds;
    float size = 0;
    if (!box.empty()) size = box_extent(box);
    const F s = max(abs(rays_.o.z), max(abs(rays_.o.y), max(abs(rays_.o.x), F(size))));
    const F speed = max(abs(rays_.d.z), max(abs(rays_.d.y), abs(rays_.d.x)));
    return select(s <= F(std::numeric_limits<float>::max()), F(0x1p-22f) * (s / speed), F(0.0f));
  }

  /// Calls visit(leaf, lanes) for the leaves along the rays, up to `end`, until it returns false.
  template <class Visit>
  OKTETT_INLINE bool walk(const F& end, Visit&& visit) const {
    const Accel& solids = *csg_.solids;
    const typename F::M negative[3] = {rays_.d.x < F(0.0f), rays_.d.y < F(0.0f), rays_.d.z < F(0.0f)};
    return visit_leaves(
        solids, lanes_,
        [&](const BvhNode& node, unsigned lanes, auto&& push) {
          for (int c = 0; c < BvhNode::kWidth; ++c) {
            F near_planes[3], far_planes[3];
            for (int k = 0; k < 3; ++k) {
              const F lo(node.plane[2 * k][c]), hi(node.plane[2 * k + 1][c]);
              near_planes[k] = select(negative[k], hi, lo), far_planes[k] = select(negative[k], lo, hi);
            }
            F near, far;
            slab_interval(rays_.o, inv_, near_planes, far_planes, rays_.tmin, end, slab_slack_, near, far);
            push(c, lanes & lanes_ & bits(near <= far));
          }
        },
        [&](NodeRef leaf, unsigned lanes) { return visit(solids.leaves[leaf.table_index()], lanes); });
  }

  OKTETT_INLINE bool gather_leaf(const LeafEntry& leaf, unsigned lanes, bool unbounded) {
    for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count && lanes != 0; ++k) {
      const int first = rows_.rows;
      if (first + CrossingLanes<N>::kMostPerSolid > CrossingLanes<N>::kMost) return false;
      if (solids_ == CrossingLanes<N>::kMost) return false;
      const std::uint32_t item =
          is_exact(leaf.kind) ? gather_exact(leaf.kind, k, lanes) : gather_shape(leaf.kind, k, lanes);
      begin_solid(first, item, lanes, unbounded);
      lanes &= lanes_;
    }
    return true;
  }

  OKTETT_INLINE std::uint32_t gather_exact(Kind kind, std::uint32_t k, unsigned lanes) {
    const ExactPoolBase& pool = csg_.solids->exact_pool(kind);
    exact_code<A>(kind).rows(pool, k, rays_, lanes, rows_);
    return pool.item_of_cell(k);
  }

  OKTETT_INLINE std::uint32_t gather_shape(Kind kind, std::uint32_t k, unsigned lanes) {
    std::uint32_t item = kNoId;
    visit_pool(kind, csg_.solids->pools, [&]<class S>(S, const typename S::Pool& pool) {
      if constexpr (kSolid<S>) item = shape_rows<S>(pool, k, lanes, rows_);
    });
    return item;
  }

  /// Shapes without an inside are no solids.
  OKTETT_INLINE void list_shape(Kind kind, std::uint32_t k, unsigned lanes, const RayLists<N>& out) const {
    visit_pool(kind, csg_.solids->pools, [&]<class S>(S, const typename S::Pool& pool) {
      if constexpr (kSolid<S>) {
        CrossingLanes<N> rows;
        shape_rows<S>(pool, k, lanes, rows);
        for (int row = 0; row < rows.rows; ++row)
          for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
            const int i = __builtin_ctz(rest);
            if (rows.t[row][i] <= std::numeric_limits<float>::max())
              out.list[i]->push({rows.t[row][i], 0, 0, rows.item[row], kNoId}, rows.turn[row][i]);
          }
      }
    });
  }

  template <class S>
  OKTETT_INLINE std::uint32_t shape_rows(const typename S::Pool& pool, std::uint32_t k, unsigned lanes,
                                         CrossingLanes<N>& rows) const {
    const auto shape = S::template broadcast<D>(pool, k);
    D t[S::kRoots];
    const auto meets = mask_cast<float>(S::roots(doubles_, shape, t)) & F::M::from_bits(lanes);
    if (none(meets)) return pool.item[k];
    for (int j = 0; j < S::kRoots; ++j) {
      const F tf = to_float(t[j]);
      const auto valid = meets & (rays_.tmin < tf) & (tf <= F(std::numeric_limits<float>::max()));
      F turn(j == 0 ? -1.0f : 1.0f);
      if constexpr (kSolid<S> && S::kRoots == 1)
        turn = select(mask_cast<float>(dot_lanes(shape.n, doubles_.d) < D(0.0)), F(-1.0f), F(1.0f));
      push_row(rows, valid, tf, turn, F(0.0f), pool.item[k], false);
    }
    return pool.item[k];
  }

  /// Notes a solid whose rows begin at `first`. Rays whose first crossing leaves it begin inside.
  OKTETT_INLINE void begin_solid(int first, std::uint32_t item, unsigned lanes, bool unbounded) {
    unsigned met = 0, begun = 0;
    for (int row = first; row < rows_.rows; ++row) {
      const unsigned here = bits(F::load(rows_.t[row]) <= F(std::numeric_limits<float>::max())) & ~met;
      begun |= here & bits(F::load(rows_.turn[row]) > F(0.0f));
      met |= here;
    }
    const std::uint32_t geometry = csg_.solids->geometry_of(item);
    if (unbounded) begun |= asked(geometry, lanes & ~met);
    // Rays that are never inside a needed solid do not hit the combination.
    const bool needed = csg_.needed[geometry] != 0;
    if (needed) lanes_ &= ~(lanes & ~(met | begun));
    if (rows_.rows == first && begun == 0) return;
    const int s = solids_++;
    if (needed && needed_count_ < kMostNeeded) needed_[needed_count_++] = s;
    operand_[s] = csg_.operand_of[geometry];
    end_[s] = rows_.rows;
    select(F::M::from_bits(begun), F(1.0f), F(0.0f)).store(depth_[s]);
    inside_[s] = begun;
  }

  /// Those of `lanes` that run inside an unbounded solid whose boundary they do not cross.
  OKTETT_NOINLINE unsigned asked(std::uint32_t geometry, unsigned lanes) const {
    unsigned inside = 0;
    float o[3][N], d[3][N], tmin[N];
    rays_.o.x.store(o[0]), rays_.o.y.store(o[1]), rays_.o.z.store(o[2]);
    rays_.d.x.store(d[0]), rays_.d.y.store(d[1]), rays_.d.z.store(d[2]);
    rays_.tmin.store(tmin);
    for (; lanes != 0; lanes &= lanes - 1) {
      const int i = __builtin_ctz(lanes);
      if (runs_inside(*csg_.solids, geometry,
                      {{o[0][i], o[1][i], o[2][i]}, tmin[i], {d[0][i], d[1][i], d[2][i]}}))
        inside |= 1u << i;
    }
    return inside;
  }

  /// Applies the crossings in (limit, end]; returns the nearest distance beyond.
  OKTETT_INLINE F advance(const F& limit, const F& end) {
    const F inf(std::numeric_limits<float>::infinity());
    F after = inf;
    int row = 0;
    for (int s = 0; s < solids_; ++s) {
      if (row == end_[s]) continue;
      F depth = F::load(depth_[s]);
      for (; row < end_[s]; ++row) {
        const F t = F::load(rows_.t[row]);
        const auto beyond = t > end;
        depth = select((t > limit) & ~beyond, depth - F::load(rows_.turn[row]), depth);
        after = select(beyond, min(t, after), after);
      }
      depth.store(depth_[s]);
      inside_[s] = bits(depth > F(0.0f));
    }
    return after;
  }

  /// The rays that are inside the combination, if those in `inside` are inside of each solid.
  OKTETT_INLINE unsigned evaluate(const std::vector<CsgStep>& steps, const unsigned* inside) const {
    unsigned possible = lanes_;
    for (int i = 0; i < needed_count_; ++i) possible &= inside[needed_[i]];
    if (possible == 0) return 0;
    const auto count = static_cast<std::uint32_t>(steps.size());
    std::uint32_t state[kMaxPlaces];
    const CsgStep* step = steps.data();
    for (std::uint32_t i = 0; i < count; ++i) state[i] = step[i].initial;
    for (int s = 0; s < solids_; ++s) state[operand_[s]] |= inside[s];
    for (std::uint32_t i = count; i-- > 1;) state[step[i].parent] &= state[i] ^ step[i].flip;
    return (state[0] ^ step[0].flip) & possible;
  }

  /// Which of the crossings decide where the rays in `several` turn, see mark_decisive in csg_sweep.cpp.
  struct Decisive {
    unsigned rays[CrossingLanes<N>::kMost];  ///< per row
    unsigned any = 0;
  };
  template <class Meant>
  OKTETT_NOINLINE void mark_decisive(const std::vector<CsgStep>& steps, const F& limit, const F& end,
                                     unsigned several, unsigned now, Meant&& meant,
                                     Decisive& decisive) const {
    unsigned states[CrossingLanes<N>::kMost], before[CrossingLanes<N>::kMost];
    alignas(64) float depth_before[CrossingLanes<N>::kMost][N];
    int row = 0;
    for (int s = 0; s < solids_; ++s) {
      F depth = F::load(depth_[s]);
      for (; row < end_[s]; ++row) {
        const F t = F::load(rows_.t[row]);
        depth = select((t > limit) & (t <= end), depth + F::load(rows_.turn[row]), depth);
      }
      depth.store(depth_before[s]);
      before[s] = bits(depth > F(0.0f));
    }
    const unsigned then = evaluate(steps, before);
    row = 0;
    for (int s = 0; s < solids_; ++s)
      for (; row < end_[s]; ++row) {
        decisive.rays[row] = 0;
        const unsigned here = bits(meant(row, F::load(rows_.t[row]))) & several;
        if (here == 0) continue;
        const F turn = F::load(rows_.turn[row]);
        std::copy_n(inside_, solids_, states);
        states[s] = bits(F::load(depth_[s]) + turn > F(0.0f));
        const unsigned without = evaluate(steps, states) ^ now;
        std::copy_n(before, solids_, states);
        states[s] = bits(F::load(depth_before[s]) - turn > F(0.0f));
        decisive.rays[row] = here & (without | (evaluate(steps, states) ^ then));
        decisive.any |= decisive.rays[row];
      }
  }

  /// Chooses the hits of the rays in `turned` among the crossings in (limit, end], the first of which is at
  /// `next`; see CsgSweep. `now`: the rays that enter the combination. Returns those that have a hit: others
  /// pass what has no surface.
  OKTETT_NOINLINE unsigned resolve(const std::vector<CsgStep>& steps, const F& limit, const F& end,
                                   const F& next, unsigned turned, unsigned now, Found& found) const {
    const F inf(std::numeric_limits<float>::infinity());
    const F want = select(F::M::from_bits(now), F(-1.0f), F(1.0f));
    const auto meant = [&](int row, const F& t) {
      return (t > limit) & (t <= end) & (F::load(rows_.turn[row]) == want);
    };
    const auto is_seen = [&](int row) {
      return csg_.unseen.empty() || csg_.unseen[csg_.solids->geometry_of(rows_.item[row])] == 0;
    };
    F same = inf;
    auto matched = inf < inf, several = matched;
    for (int row = 0; row < rows_.rows; ++row) {
      const F t = F::load(rows_.t[row]);
      const auto likewise = meant(row, t);
      several = several | (matched & likewise), matched = matched | likewise;
      if (is_seen(row)) same = select(likewise, min(t, same), same);
    }
    // Of several crossings that coincide only those count that decide.
    Decisive decisive;
    const unsigned asked = bits(several) & turned;
    if (asked != 0) mark_decisive(steps, limit, end, asked, now, meant, decisive);
    const auto counts = [&](int row) {
      constexpr unsigned kAll = (1u << N) - 1;
      return F::M::from_bits((~decisive.any | decisive.rays[row]) & kAll);
    };
    if (decisive.any != 0) {
      same = inf;
      for (int row = 0; row < rows_.rows; ++row) {
        const F t = F::load(rows_.t[row]);
        if (is_seen(row)) same = select(meant(row, t) & counts(row), min(t, same), same);
      }
    }
    const F chosen = select(matched, same, next);
    I least(0x7fffffff), at(0);
    for (int row = 0; row < rows_.rows; ++row) {
      if (!is_seen(row)) continue;
      const F t = F::load(rows_.t[row]);
      auto candidate = (t == chosen) & (t > limit) & (meant(row, t) | ~matched);
      if (decisive.any != 0) candidate = candidate & (counts(row) | ~matched);
      const I item(static_cast<std::int32_t>(rows_.item[row]));
      const auto before = mask_cast<std::int32_t>(candidate) & (item < least);
      least = select(before, item, least), at = select(before, I(row), at);
    }
    turned &= bits(least < I(0x7fffffff));
    const auto here = F::M::from_bits(turned);
    select(here, chosen, F::load(found.t)).store(found.t);
    select(mask_cast<std::int32_t>(here), at, I::load(found.row)).store(found.row);
    found.lanes |= turned;
    found.flipped |= turned & ~bits(matched);
    return turned;
  }

  /// Greatest number of steps of an expression.
  static constexpr std::size_t kMaxPlaces = 512;

  /// Greatest number of needed solids that are checked before the expression is evaluated.
  static constexpr int kMostNeeded = 4;

  const CsgItem& csg_;
  unsigned lanes_;
  RayLanes<F> rays_;
  RayLanes<D> doubles_;
  Vec3<F> inv_;
  F slab_slack_;
  int solids_ = 0, needed_count_ = 0;
  int needed_[kMostNeeded];
  std::uint32_t operand_[CrossingLanes<N>::kMost];  ///< per solid: its node, in sweep() the index of its step
  int end_[CrossingLanes<N>::kMost];                ///< one past its last row
  unsigned inside_[CrossingLanes<N>::kMost];        ///< the rays inside of it
  alignas(64) float depth_[CrossingLanes<N>::kMost][N];
  CrossingLanes<N> rows_;
};

// ---- Rays against Boolean combinations: gathers the crossings with all solids, sweeps them, takes the
// first.

template <class A>
void collect(const Accel& accel, const RayState<1, A>& r, HitList& hits);

template <class A>
void collect_leaf(const Accel& accel, const LeafEntry& leaf, const RayState<1, A>& r, HitList& hits);

/// Appends all crossings of a ray with the solids of a combination, from tmin to infinity: crossings beyond
/// tmax also tell whether the ray begins inside a solid. False for a ray that can hit nothing.
template <class A>
OKTETT_NOINLINE bool gather_solids(const CsgItem& csg, const Ray& ray, HitList& crossings) {
  RayState<1, A> state;
  if (state.set({ray.origin, ray.tmin, ray.direction, std::numeric_limits<float>::infinity()},
                csg.solids->bounds) == 0)
    return false;
  for (const CsgProbe& probe : csg.probes) {
    collect_leaf(*csg.solids, probe.leaf, state, crossings);
    const bool met = crossings.size() > 0;
    crossings.shrink(0);
    if (!met && !(probe.unbounded && runs_inside(*csg.solids, probe.geometry, ray))) return false;
  }
  collect(*csg.solids, state, crossings);
  return true;
}

/// The rays in `lanes` against a combination, one by one.
template <int W, class A>
OKTETT_NOINLINE void csg_singly(const CsgItem& csg, RayState<W, A>& r, unsigned lanes) {
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    const Ray ray{{r.o[0][i], r.o[1][i], r.o[2][i]}, r.tmin[i], {r.d[0][i], r.d[1][i], r.d[2][i]}, r.tmax[i]};
    CsgSweep sweep;
    Crossing found;
    if (gather_solids<A>(csg, ray, sweep.solids()) && sweep.first(csg, ray, found))
      accept_hit(r, i, found.hit.t, found.hit.u, found.hit.v, found.hit.item, found.hit.instance);
  }
}

/// The rays in `lanes` of the CsgLanes<A>::N rays from `base` on against a combination, at once.
template <int W, class A>
OKTETT_NOINLINE void csg_together(const CsgItem& csg, RayState<W, A>& r, int base, unsigned lanes) {
  CsgLanes<A> packet(csg, r, base, lanes);
  typename CsgLanes<A>::Found found;
  if (!packet.first(found)) return csg_singly(csg, r, lanes << base);
  const auto& rows = packet.rows();
  for (unsigned rest = found.lanes; rest != 0; rest &= rest - 1) {
    const int i = __builtin_ctz(rest), row = found.row[i];
    accept_hit(r, base + i, found.t[i], rows.part[row][i], rows.exact[row] ? rows.turn[row][i] : 0.0f,
               rows.item[row], csg_path(csg, kNoId, (found.flipped >> i & 1) != 0));
  }
}

/// The rays in `lanes` of the CsgLanes<A>::N rays from `base` on against a combination of shapes: solved at
/// once, swept one by one.
template <int W, class A>
OKTETT_NOINLINE void csg_listed(const CsgItem& csg, RayState<W, A>& r, int base, unsigned lanes) {
  constexpr int N = CsgLanes<A>::N;
  CsgLanes<A> packet(csg, r, base, lanes);
  lanes = packet.probe();
  // A ray alone is faster by itself.
  if ((lanes & (lanes - 1)) == 0) return csg_singly(csg, r, lanes << base);
  CsgSweep sweeps[N];
  RayLists<N> lists;
  for (int i = 0; i < N; ++i) lists.list[i] = &sweeps[i].solids();
  packet.list(lists);
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes), k = base + i;
    if (lists.list[i]->size() == 0) continue;
    merge_crossings(*csg.solids, *lists.list[i], 0);
    const Ray ray{{r.o[0][k], r.o[1][k], r.o[2][k]}, r.tmin[k], {r.d[0][k], r.d[1][k], r.d[2][k]}, r.tmax[k]};
    Crossing found;
    if (sweeps[i].first(csg, ray, found))
      accept_hit(r, k, found.hit.t, found.hit.u, found.hit.v, found.hit.item, found.hit.instance);
  }
}

/// Those of `lanes` that run through all windows of the combination.
template <int W, class A>
OKTETT_NOINLINE unsigned through_windows(const CsgItem& csg, const RayState<W, A>& r, unsigned lanes) {
  unsigned through = 0;
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    const Ray ray{{r.o[0][i], r.o[1][i], r.o[2][i]}, r.tmin[i], {r.d[0][i], r.d[1][i], r.d[2][i]}, r.tmax[i]};
    if (runs_through_windows(csg, ray)) through |= 1u << i;
  }
  return through;
}

/// The rays in `lanes` against the combinations of a leaf.
template <int W, class A>
OKTETT_NOINLINE void leaf_csg(const Accel& accel, const LeafEntry& leaf, RayState<W, A>& r, unsigned all) {
  constexpr int N = CsgLanes<A>::N;
  for (std::uint32_t k = leaf.begin; k < leaf.begin + leaf.count; ++k) {
    const CsgItem& csg = accel.combinations[k];
    const unsigned lanes = csg.windows.empty() ? all : through_windows<W, A>(csg, r, all);
    if (!csg.in_lanes && !(csg.listed && N > 1)) {
      csg_singly(csg, r, lanes);
      continue;
    }
    for (int base = 0; base < W; base += N) {
      const unsigned part = lanes >> base & ((2u << (N - 1)) - 1);
      if (part == 0) continue;
      if (csg.in_lanes)
        csg_together(csg, r, base, part);
      else
        csg_listed(csg, r, base, part);
    }
  }
}

/// Appends every crossing of a ray with a combination.
template <class A>
OKTETT_NOINLINE void collect_csg(const CsgItem& csg, const Ray& ray, HitList& hits) {
  // Windows do not count where the crossings are to tell what is inside.
  if (!csg.windows.empty() && !hits.keeps_unseen && !runs_through_windows(csg, ray)) return;
  CsgSweep sweep;
  if (gather_solids<A>(csg, ray, sweep.solids())) sweep.all(csg, ray, hits);
}

}  // namespace oktett
