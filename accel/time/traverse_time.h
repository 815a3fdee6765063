#pragma once
/// \file One ray through a tree whose boxes move.

#include "accel/time/time_tree.h"
#include "accel/traverse/inflight/solo.h"

namespace oktett {

/// `Moves`: there are several keys.
template <Query Q, bool Moves, class A>
class TimeTraversal {
 public:
  OKTETT_INLINE TimeTraversal(const TimeTree& tree, float time, const TimeCalls& calls)
      : tree_(tree), calls_(calls), at_(KeyTime::of(time, tree.keys)), rest_(1 - at_.f), part_(at_.f) {
    if (tree.nodes.empty()) return;
    links_ = tree.nodes[0].data();
    before_ = tree.nodes[at_.key].data();
    if constexpr (Moves) after_ = tree.nodes[at_.key + 1].data();
  }

  Hit run(const Ray& ray) {
    ray_ = &ray, nearest_.t = ray.tmax;
    if (tree_.root.is_none()) return {};
    if constexpr (!std::is_same_v<A, ScalarIsa>) {
      const SoloRay<A> prepared(ray, tree_.bounds);
      if (OKTETT_LIKELY(prepared.is_tame)) {
        traverse(prepared);
        return found();
      }
    }
    if (set_state()) traverse_exactly();
    return found();
  }

 private:
  static constexpr int N = BvhNode::kWidth;
  using F = Simd<float, N, A>;

  OKTETT_INLINE Hit found() const { return nearest_.valid() ? nearest_ : Hit{}; }
  OKTETT_INLINE bool is_finished() const { return Q == Query::any && nearest_.valid(); }

  /// In the float arithmetic of SoloTraversal.
  OKTETT_INLINE void traverse(const SoloRay<A>& ray) {
    Siblings<Q, A> waiting[kMaxDepth + 1];
    int top = -1;
    const auto each = [](const float(&v)[4]) { return std::array{F(v[0]), F(v[1]), F(v[2])}; };
    const std::array<F, 3> inverse = each(ray.inv), near_shift = each(ray.near_shift),
                           far_shift = each(ray.far_shift);
    const std::uint32_t near_row[3] = {ray.near_row(0), ray.near_row(1), ray.near_row(2)};
    // Adding zero turns -0 into 0, because near distances are sorted by their bits.
    const F tmin(ray_->tmin + 0.0f);
    float limit = nearest_.t + ray.slack[0];
    NodeRef ref = tree_.root;
    for (;;) {
      if (!ref.is_leaf()) {
        const std::uint32_t index = ref.node_index();
        F near;
        const F far = fused_interval<F>([&](std::uint32_t offset) { return row(index, offset); }, near_row,
                                        inverse, near_shift, far_shift, tmin, F(limit), near);
        const auto given = near <= far;
        if (const unsigned met = bits(given); met != 0) {
          Siblings<Q, A>& here = waiting[top + 1];
          ref = here.set(ref, links_[index], near, given, met);
          top += !here.empty();
          continue;
        }
      } else {
        leaf(tree_.leaves[ref.table_index()]);
        if (is_finished()) return;
        limit = nearest_.t + ray.slack[0];
      }
      while (top >= 0 && waiting[top].beyond(limit)) --top;
      if (top < 0) return;
      ref = waiting[top].take(links_);
      top -= waiting[top].empty();
    }
  }

  /// The same for rays whose numbers do not suit that.
  OKTETT_NOINLINE void traverse_exactly() {
    StackEntry stack[kStackSize];
    int size = 0;
    NodeRef ref = tree_.root;
    alignas(64) float near[BvhNode::kWidth];
    for (;;) {
      if (!ref.is_leaf()) {
        const NodeRef* const child = links_[ref.node_index()].child;
        if (const unsigned met = meet(ref.node_index(), child, near); met != 0) {
          size = push_sorted(child, met, near, stack, size);
          ref = stack[--size].ref;
          continue;
        }
      } else {
        leaf(tree_.leaves[ref.table_index()]);
        if (is_finished()) return;
        r_.tmax[0] = nearest_.t;
      }
      const float limit = r_.tmax[0] * kSlabRelativeSlack + r_.slack[0];
      do {
        if (size == 0) return;
        --size;
      } while (stack[size].near > limit);
      ref = stack[size].ref;
    }
  }

  /// Sets the state for exact tests. Returns whether the ray can hit anything.
  OKTETT_INLINE bool set_state() {
    has_state_ = true;
    return r_.set(*ray_, tree_.bounds) != 0;
  }

  /// A row of numbers at the time of the ray.
  OKTETT_INLINE F between(const float* a, const float* b) const {
    return rest_ * F::load(a) + part_ * F::load(b);
  }
  /// The planes at an offset in a node, at the time of the ray.
  OKTETT_INLINE F row(std::uint32_t index, std::uint32_t offset) const {
    const float* const a = &before_[index].plane[0][0] + offset;
    if constexpr (Moves) return between(a, &after_[index].plane[0][0] + offset);
    return F::load(a);
  }

  /// The children whose boxes the ray meets, a bit each, and where it enters them.
  OKTETT_INLINE unsigned meet(std::uint32_t index, const NodeRef* child, float* near) const {
    F near_planes[3], far_planes[3];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t near_row = near_offset(k, r_.negative[k] & 1);
      near_planes[k] = row(index, near_row), far_planes[k] = row(index, near_row ^ BvhNode::kWidth);
    }
    F n, f;
    slab_interval({F(r_.o[0][0]), F(r_.o[1][0]), F(r_.o[2][0])},
                  {F(r_.inv[0][0]), F(r_.inv[1][0]), F(r_.inv[2][0])}, near_planes, far_planes, F(r_.tmin[0]),
                  F(r_.tmax[0]), F(r_.slack[0]), n, f);
    n.store(near);
    unsigned met = bits(n <= f);
    // Boxes that are turned inside out may be met by rays along an axis, whose distances to planes are
    // infinite.
    for (unsigned m = met; m != 0; m &= m - 1)
      if (child[__builtin_ctz(m)].is_none()) met &= ~(m & -m);
    return met;
  }

  OKTETT_INLINE void leaf(const LeafEntry& leaf) {
    if (leaf.kind == Kind::box) return triangles(leaf);
    Ray to_nearest = *ray_;
    to_nearest.tmax = nearest_.t;
    const std::uint32_t item = tree_.called_items[leaf.begin];
    Hit hit = nearest_;
    if (calls_.test(calls_.self, item, to_nearest, hit)) nearest_ = {hit.t, hit.u, hit.v, item, kNoId};
  }

  OKTETT_INLINE void triangles(const LeafEntry& leaf) {
    const MovingCorners* const corners = &tree_.corners[std::size_t{leaf.begin} * tree_.keys + at_.key];
    const auto corner = [&](int c, int axis) {
      const float* const a = corners[0].at[c][axis];
      if constexpr (Moves) return between(a, corners[1].at[c][axis]);
      return F::load(a);
    };
    const auto permuted = [&](int z) {
      const auto at = [&](int c) {
        return Vec3<F>{corner(c, (z + 1) % 3), corner(c, (z + 2) % 3), corner(c, z)};
      };
      return TriangleLanes<F>{at(0), at(1), at(2)};
    };
    if (!has_state_) set_state();
    r_.tmax[0] = nearest_.t;
    const auto ray = broadcast_ray<N>(r_);
    unsigned lanes =
        bits(filter_watertight(ray, F(r_.d_max[0]), filter_triangle(permuted(2)))) & ((1u << leaf.count) - 1);
    if (lanes == 0) return;
    HitLanes<F> hits;
    lanes &=
        bits(decide_watertight(broadcast_shear<N>(r_), permuted(r_.z_axis_of(0)), ray.tmin, ray.tmax, hits));
    const std::uint32_t* const items = tree_.block_items[leaf.begin].data();
    each_hit(lanes, hits, [&](int k, float t, float u, float v) {
      const Hit hit{t, u, v, items[k], kNoId};
      if (is_finished() || !is_before(hit)) return;
      if (calls_.accept == nullptr || calls_.accept(calls_.self, hit)) nearest_ = hit;
    });
  }

  /// Whether a hit would be the nearest so far.
  OKTETT_INLINE bool is_before(const Hit& hit) const {
    return hit.t < nearest_.t || (hit.t == nearest_.t && (!nearest_.valid() || hit.item < nearest_.item));
  }

  const TimeTree& tree_;
  const TimeCalls& calls_;
  const KeyTime at_;
  const F rest_, part_;
  const BvhNode *links_ = nullptr, *before_ = nullptr, *after_ = nullptr;
  const Ray* ray_ = nullptr;
  Hit nearest_;  ///< its t is the end of the ray if there is none
  RayState<1, A> r_;
  bool has_state_ = false;
};

}  // namespace oktett
