#pragma once
/// \file One ray through a tree whose boxes move.

#include "accel/time/time_tree.h"
#include "accel/traverse/single.h"

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
    if (tree_.root.is_none() || r_.set(ray, tree_.bounds) == 0) return {};
    StackEntry stack[kStackSize];
    int size = 0;
    NodeRef ref = tree_.root;
    alignas(64) float near[BvhNode::kWidth];
    for (;;) {
      if (!ref.is_leaf()) {
        const NodeRef* const child = links_[ref.node_index()].child;
        const unsigned met = meet(ref.node_index(), child, near);
        if (met != 0) {
          if ((met & (met - 1)) == 0) {
            ref = child[__builtin_ctz(met)];
            continue;
          }
          size = push_sorted(child, met, near, stack, size);
          ref = stack[--size].ref;
          continue;
        }
      } else {
        leaf(tree_.leaves[ref.table_index()], ray);
        if (Q == Query::any && r_.item[0] != kNoId) break;
      }
      const float limit = r_.tmax[0] * kSlabRelativeSlack + r_.slack[0];
      do {
        if (size == 0) return r_.hit(0);
        --size;
      } while (stack[size].near > limit);
      ref = stack[size].ref;
    }
    return r_.hit(0);
  }

 private:
  static constexpr int N = BvhNode::kWidth;
  using F = Simd<float, N, A>;

  /// A row of numbers at the time of the ray.
  OKTETT_INLINE F between(const float* a, const float* b) const {
    return rest_ * F::load(a) + part_ * F::load(b);
  }

  /// The children whose boxes the ray meets, a bit each, and where it enters them.
  OKTETT_INLINE unsigned meet(std::uint32_t index, const NodeRef* child, float* near) const {
    const BvhNode& node = before_[index];
    F near_planes[3], far_planes[3];
    for (int k = 0; k < 3; ++k) {
      const int negative = static_cast<int>(r_.negative[k] & 1);
      const auto row = [&](int side) {
        const float* const a = node.plane[2 * k + side];
        if constexpr (Moves) return between(a, after_[index].plane[2 * k + side]);
        return F::load(a);
      };
      near_planes[k] = row(negative), far_planes[k] = row(negative ^ 1);
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

  OKTETT_INLINE void leaf(const LeafEntry& leaf, const Ray& ray) {
    if (leaf.kind == Kind::box) return triangles(leaf);
    Ray to_nearest = ray;
    to_nearest.tmax = r_.tmax[0];
    const std::uint32_t item = tree_.called_items[leaf.begin];
    Hit hit = r_.hit(0);
    if (calls_.test(calls_.self, item, to_nearest, hit)) accept_hit(r_, 0, hit.t, hit.u, hit.v, item, kNoId);
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
    const auto ray = broadcast_ray<N>(r_);
    unsigned lanes =
        bits(filter_watertight(ray, F(r_.d_max[0]), filter_triangle(permuted(2)))) & ((1u << leaf.count) - 1);
    if (lanes == 0) return;
    HitLanes<F> hits;
    lanes &=
        bits(decide_watertight(broadcast_shear<N>(r_), permuted(r_.z_axis_of(0)), ray.tmin, ray.tmax, hits));
    const std::uint32_t* const items = tree_.block_items[leaf.begin].data();
    each_hit(lanes, hits, [&](int k, float t, float u, float v) {
      const std::uint32_t item = items[k];
      if (calls_.accept != nullptr) {
        const bool found = r_.item[0] != kNoId;
        if ((Q == Query::any && found) || t > r_.tmax[0] || (t == r_.tmax[0] && found && item > r_.item[0]) ||
            !calls_.accept(calls_.self, {t, u, v, item, kNoId}))
          return;
      }
      accept_hit(r_, 0, t, u, v, item, kNoId);
    });
  }

  const TimeTree& tree_;
  const TimeCalls& calls_;
  const KeyTime at_;
  const F rest_, part_;
  const BvhNode *links_ = nullptr, *before_ = nullptr, *after_ = nullptr;
  RayState<1, A> r_;
};

}  // namespace oktett
