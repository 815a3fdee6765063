#pragma once
/// \file A beam through the tree: nodes and triangles are culled against the whole beam first, then against
/// its groups of sixteen rays.
///
/// A conservative filter in float tells sure hits from unclear ones. A sure hit that is surely nearer than
/// the nearest so far becomes the candidate of its ray; unclear ones go to a list. Candidates and list are
/// decided exactly at the end, all lanes busy, so the hits have the same bits as those of every other
/// traversal.

#include "accel/traverse/beam/beam_instances.h"
#include "accel/traverse/beam/beam_shapes.h"
#include "accel/traverse/ways.h"
#include "core/simd_order.h"

namespace oktett {

/// A stack entry: a node or leaf, its box in the plane of the beam, and the groups that may meet it.
struct BeamEntry {
  NodeRef ref;
  float near;  ///< greatest inverse depth in the box
  float x_lo, x_hi, y_lo, y_hi;
  unsigned groups;
};

/// The boxes of a node's children in the plane of a beam.
struct alignas(32) ChildWindows {
  float near[BvhNode::kWidth], x_lo[BvhNode::kWidth], x_hi[BvhNode::kWidth], y_lo[BvhNode::kWidth],
      y_hi[BvhNode::kWidth];
};

/// Children of `node` whose boxes meet the window.
template <class A>
OKTETT_INLINE unsigned node_beam(const BvhNode& node, const BeamRays<A>& beam, const BeamWindow& w,
                                 ChildWindows& out) {
  using B = Simd<float, BvhNode::kWidth, A>;
  const int kx = 2 * beam.axis[0], ky = 2 * beam.axis[1], kz = 2 * beam.axis[2];
  const B ox(beam.apex[0]), oy(beam.apex[1]), oz(beam.apex[2]);
  const B xl = B::load(node.plane[kx]) - ox, xh = B::load(node.plane[kx + 1]) - ox;
  const B yl = B::load(node.plane[ky]) - oy, yh = B::load(node.plane[ky + 1]) - oy;
  const B z_low = B::load(node.plane[kz]) - oz, z_high = B::load(node.plane[kz + 1]) - oz;
  const B zn = beam.mirrored ? -z_high : z_low, zf = beam.mirrored ? -z_low : z_high;
  const B margin(beam.margin + beam.slip), infinity(std::numeric_limits<float>::infinity());
  // False for boxes behind the apex, or so near its plane that rounding counts for more than kBeamSlack.
  const auto front = zn > B(beam.margin * 0x1p20f + 4 * beam.behind);
  const B rn = B(1 + kBeamSlack) / zn, rf = B(1 - kBeamSlack) / zf, wide = margin * rn;
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
    const B behind(beam.behind + beam.margin);
    const B zc = max(zn, -behind);
    const auto side = [&](const B& coordinate, float slope) {
      const B bound = B(slope) * (slope > 0 ? zc : zf);
      return coordinate - bound + (abs(coordinate) + abs(bound)) * B(kBeamSlack) + (margin + behind) >=
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

/// The groups of `e` that may meet its box.
template <class A>
OKTETT_INLINE unsigned entry_groups(const BeamEntry& e, const BeamRays<A>& beam) {
  using G = Simd<float, kBeamGroups, A>;
  return e.groups & bits((G::load(beam.x_lo) <= G(e.x_hi)) & (G(e.x_lo) <= G::load(beam.x_hi)) &
                         (G::load(beam.y_lo) <= G(e.y_hi)) & (G(e.y_lo) <= G::load(beam.y_hi)) &
                         (G::load(beam.least) < G(e.near)));
}

/// The rays of one group that may meet the box of `e`.
template <class A>
OKTETT_INLINE unsigned entry_rays(const BeamEntry& e, const BeamRays<A>& beam, int group) {
  using F = Simd<float, kBeamGroup, A>;
  const int base = group * kBeamGroup;
  const F x = F::load(beam.x + base), y = F::load(beam.y + base);
  return bits((x <= F(e.x_hi)) & (F(e.x_lo) <= x) & (y <= F(e.y_hi)) & (F(e.y_lo) <= y) &
              (F::load(beam.hit_lo + base) < F(e.near)));
}

/// The rays of some groups against a triangle that cannot be projected, by the filter for single triangles.
template <Query Q, class A>
OKTETT_NOINLINE void meet_edge_on(BeamTask<Q, A>& task, std::uint32_t id, unsigned groups) {
  using F = Simd<float, kBeamGroup, A>;
  const auto tri = filter_triangle(broadcast_triangle<F>(task.accel.triangles(id / TriangleBlock::kSize),
                                                         static_cast<int>(id % TriangleBlock::kSize)));
  for (; groups != 0; groups &= groups - 1) {
    const int g = __builtin_ctz(groups);
    const RayLanes<F> r = load_group(task.beam, task.rays, g);
    const F d_max = max(abs(r.d.x), max(abs(r.d.y), abs(r.d.z)));
    note_unclear(task, open_rays(task.beam, g) & bits(filter_watertight(r, d_max, tri)), g, id);
  }
}

/// Groups of a beam against a block of triangles. Sets the bits of groups with new hits in `dirty`; returns
/// the number of pairs of a triangle and a group that were tested.
template <Query Q, class A>
OKTETT_INLINE int leaf_beam(BeamTask<Q, A>& task, NodeRef ref, unsigned groups, const BeamWindow& window,
                            unsigned& dirty) {
  BeamRays<A>& beam = task.beam;
  ProjectedTriangles<A> projected;
  const TriangleLeaf leaf = task.accel.triangles(ref.triangle_leaf());
  const BlockCandidates found = project_block(leaf, ref.triangle_count(), beam, window, projected);
  const std::uint32_t base = ref.triangle_leaf() * TriangleBlock::kSize;
  // All pairs first: one loop, whose end is mispredicted once, instead of eight.
  std::int32_t pairs[(TriangleBlock::kSize + 1) * kBeamGroups];
  int size = 0;
  const bool lone = (groups & (groups - 1)) == 0;
  for (unsigned rest = found.projected; rest != 0; rest &= rest - 1) {
    const int k = __builtin_ctz(rest);
    unsigned met = lone ? groups : groups_meeting(projected, k, beam, groups);
    if (task.accel.pieces) met = task.met.add(leaf.item(k), met);
    size += store_set_bits<A>(met, k * kBeamGroups, pairs + size);
  }
  for (int i = 0; i < size; ++i) {
    const int k = pairs[i] / kBeamGroups, g = pairs[i] % kBeamGroups;
    const std::uint32_t id = base + static_cast<unsigned>(k);
    const GroupVerdict verdict = meet_group<Q == Query::any>(projected, k, id, beam, g);
    dirty |= static_cast<unsigned>(verdict.sure != 0) << g;
    if (OKTETT_UNLIKELY(verdict.unclear != 0)) note_unclear(task, verdict.unclear, g, id);
  }
  for (unsigned rest = found.edge_on; OKTETT_UNLIKELY(rest != 0); rest &= rest - 1)
    meet_edge_on(task, base + static_cast<unsigned>(__builtin_ctz(rest)), groups);
  return size;
}

/// A leaf of combinations, instances or textbook triangles, against the rays `rays` of group `g`.
template <Query Q, class A>
OKTETT_NOINLINE void table_leaf_group(BeamTask<Q, A>& task, const LeafEntry& leaf, int g, unsigned rays) {
  BeamRays<A>& beam = task.beam;
  decide_group(task, g);
  const std::size_t base = static_cast<std::size_t>(g) * kBeamGroup;
  const auto r = load_group(beam, task.rays, g);
  rays &= open_rays(beam, g);
  RayState<kBeamGroup, A> state;
  rays &= state.set(r.o, r.d, r.tmin, r.tmax, task.accel.bounds);
  if (rays == 0) return;
  if constexpr (Q == Query::closest) load_hits(task.out.hits, base, state);
  table_leaf_packet<Q>(task.accel, leaf, state, rays);
  const unsigned found = found_lanes(state, rays);
  if (found == 0) return;
  if constexpr (Q == Query::any)
    block_rays<kBeamGroup>(beam, base, found);
  else
    store_hits(task.out.hits, beam, base, found, state);
  beam.refresh(g);
}

/// The same for several groups; `met(g)` are the rays of group `g` that may meet the leaf.
template <Query Q, class A, class Met>
OKTETT_INLINE void table_leaf_beam(BeamTask<Q, A>& task, const LeafEntry& leaf, unsigned groups, Met&& met) {
  if (is_shape(leaf.kind)) return shape_leaf_beam(task, leaf, groups, met);
  if (holds_instances(leaf.kind)) {
    bool inside = true;
    if (task.max_steps != kAnySteps) task.max_steps += kStepsPerInstance * leaf.count;
    for (std::uint32_t k = 0; k < leaf.count && inside; ++k)
      inside = task.instances->visit(first_instance(leaf) + k, groups, met);
    if (inside) return;
  }
  for (; groups != 0; groups &= groups - 1) {
    const int g = __builtin_ctz(groups);
    const unsigned rays = met(g);
    if (rays != 0) table_leaf_group(task, leaf, g, rays);
  }
}

/// Pushes children in the order of their distance, the nearest last.
OKTETT_INLINE int push_windows(const NodeRef* child, unsigned children, const ChildWindows& w,
                               unsigned groups, BeamEntry* stack, int size) {
  const int base = size;
  for (; children != 0; children &= children - 1) {
    const int c = __builtin_ctz(children);
    int at = size++;
    while (at > base && stack[at - 1].near > w.near[c]) stack[at] = stack[at - 1], --at;
    stack[at] = {child[c], w.near[c], w.x_lo[c], w.x_hi[c], w.y_lo[c], w.y_hi[c], groups};
  }
  return size;
}

/// At leaves, with at most so many groups, those without a ray in the box are left out.
inline constexpr int kRefinedGroups = 8;

/// Tests of a group after which sorting the rays of a beam pays.
inline constexpr int kTestsBeforeSort = 64;

/// Brings into the cache what a beam needs after its traversal, a cache line of each column per step: the
/// rays of the next beam, and the places of its own hits. Fetched all at once, these would be more lines than
/// the processor can wait for.
template <Query Q>
class Lookahead {
 public:
  Lookahead(const RaySpan& next, const HitSink<Q>& out, std::size_t size)
      : next_(next), out_(out), size_(size) {}

  OKTETT_INLINE void step() {
    if (at_ < next_.size) {
      for (int k = 0; k < 3; ++k)
        __builtin_prefetch(next_.origin[k] + at_), __builtin_prefetch(next_.direction[k] + at_);
      __builtin_prefetch(next_.tmin + at_), __builtin_prefetch(next_.tmax + at_);
    }
    if (at_ < size_) out_.prefetch(at_);
    at_ += 64 / sizeof(float);
  }

 private:
  const RaySpan& next_;
  const HitSink<Q>& out_;
  const std::size_t size_;  ///< rays of the beam
  std::size_t at_ = 0;
};

/// Sorts the rays of a beam whose stack has `size` entries.
template <Query Q, class A>
OKTETT_NOINLINE void sort_beam(BeamTask<Q, A>& task, BeamEntry* stack, int size) {
  // Lists, mailboxes and rays in instances refer to rays by their old places.
  if (task.instances != nullptr) task.instances->finish_rays();
  decide_unclear(task);
  task.met.clear();
  task.beam.sort();
  for (int i = 0; i < size; ++i) stack[i].groups = task.beam.groups;
}

/// Prefetches the children of a node above instances: nodes and what describes instances of a list.
OKTETT_INLINE void prefetch_children(const Accel& accel, const BvhNode& node, unsigned children) {
  const TreeBytes bytes(accel);
  for (; children != 0; children &= children - 1) {
    const NodeRef child = node.child[__builtin_ctz(children)];
    if (!child.is_leaf()) {
      bytes.prefetch(child);
    } else if (!child.is_triangles()) {
      const LeafEntry& leaf = accel.leaves[child.table_index()];
      if (leaf.kind == Kind::instance_list) __builtin_prefetch(&accel.listed_instances[leaf.begin]);
    }
  }
}

/// Takes the beam through the tree. False if it is given up because it takes too many steps,
/// or because too few rays meet each instance.
template <Query Q, class A>
OKTETT_NOINLINE bool traverse_beam(BeamTask<Q, A>& task, Lookahead<Q>& ahead) {
  const Accel& accel = task.accel;
  BeamRays<A>& beam = task.beam;
  BeamEntry stack[kStackSize];
  int size = 0, steps = 0, tests = 0;
  unsigned dirty = 0;  // groups whose least[] is out of date: too low, which is conservative
  stack[size++] = {accel.root,       std::numeric_limits<float>::infinity(),
                   beam.window.x_lo, beam.window.x_hi,
                   beam.window.y_lo, beam.window.y_hi,
                   beam.groups};
  ChildWindows children;
  while (size > 0) {
    const BeamEntry e = stack[--size];
    ahead.step();
    if (__builtin_popcount(dirty) >= 4) {
      for (; dirty != 0; dirty &= dirty - 1) beam.refresh(__builtin_ctz(dirty));
      beam.refresh_window();
    }
    unsigned groups = entry_groups(e, beam);
    if (groups == 0) continue;
    if (++steps > task.max_steps) return false;
    if (e.ref.is_leaf() && !e.ref.is_triangles()) {
      table_leaf_beam(task, accel.leaves[e.ref.table_index()], groups,
                      [&](int g) { return entry_rays(e, beam, g); });
      if (task.instances != nullptr) {
        dirty |= task.instances->take_dirty();
        if (task.max_steps != kAnySteps && task.instances->sparse()) return false;
      }
      beam.refresh_window();
      tests += __builtin_popcount(groups);
      if (Q == Query::any && tests >= kTestsBeforeSort && beam.may_sort) {
        sort_beam(task, stack, size);
        dirty = 0;
      }
      continue;
    }
    if (e.ref.is_triangles() && __builtin_popcount(groups) <= kRefinedGroups) {
      unsigned kept = 0;
      for (unsigned rest = groups; rest != 0; rest &= rest - 1)
        kept |= static_cast<unsigned>(entry_rays(e, beam, __builtin_ctz(rest)) != 0) << __builtin_ctz(rest);
      groups = kept;
      if (groups == 0) continue;
    }
    BeamWindow window = beam.window;
    if ((groups & (groups - 1)) == 0) {
      const int g = __builtin_ctz(groups);
      const unsigned rays = entry_rays(e, beam, g);
      if (rays == 0) continue;
      if ((rays & (rays - 1)) == 0) {
        const int i = g * kBeamGroup + __builtin_ctz(rays);
        window = {beam.x[i], beam.x[i], beam.y[i], beam.y[i], beam.hit_lo[i], {beam.x[i], beam.y[i]}};
      } else {
        window = group_window(beam, g);
      }
    }
    if (!e.ref.is_leaf()) {
      const BvhNode& node = accel.nodes[e.ref.node_index()];
      const unsigned met = node_beam(node, beam, window, children);
      size = push_windows(node.child, met, children, groups, stack, size);
      if (task.instances != nullptr) prefetch_children(accel, node, met);
    } else {
      tests += leaf_beam(task, e.ref, groups, window, dirty);
      if (Q == Query::any && OKTETT_UNLIKELY(tests >= kTestsBeforeSort) && beam.may_sort) {
        sort_beam(task, stack, size);
        dirty = 0;
      }
    }
  }
  return true;
}

enum class BeamOutcome {
  traced,
  no_beam,   ///< the rays share no point, fan out too far or are out of scale
  given_up,  ///< they took more steps than was allowed, or too few of them met each instance
};

/// Up to kBeamRays rays that meet in `apex`. Unless they are traced, nothing has been written that another
/// traversal would not overwrite. `next` are the rays that will be traced next, `instances` is null where
/// there are none.
template <Query Q, class A>
OKTETT_NOINLINE BeamOutcome trace_beam(const Accel& accel, const RaySpan& rays, const Apex& apex,
                                       const HitSink<Q>& out, int max_steps, const RaySpan& next,
                                       BeamInstances<Q, A>* instances) {
  BeamTask<Q, A> task{accel, rays, out, {}, {}, max_steps, instances};
  if (instances != nullptr) instances->begin(task);
  if (!task.beam.set(rays, apex, box_extent(accel.bounds), Q == Query::any)) return BeamOutcome::no_beam;
  if (task.beam.groups != 0) {
    if (Q == Query::closest) bound_by_planes(accel, task.beam);
    for (const LeafEntry& leaf : accel.unbounded)
      if (leaf.kind != Kind::plane)
        table_leaf_beam(task, leaf, task.beam.groups, [](int) { return (1u << kBeamGroup) - 1; });
    Lookahead<Q> ahead(next, out, rays.size);
    if (!accel.root.is_none() && !traverse_beam(task, ahead)) return BeamOutcome::given_up;
    if (instances != nullptr) instances->finish_rays();
    if (Q == Query::any) decide_planes(task);
  }
  finish_beam(task);
  if (Q == Query::closest && task.beam.groups != 0) decide_planes(task);
  return BeamOutcome::traced;
}

}  // namespace oktett
