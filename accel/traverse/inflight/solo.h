#pragma once
/// \file One ray by itself through the tree, with the float arithmetic of interleaved rays: triangles are
/// classified, and the nearest hit is decided when the ray is finished.

#include <array>
#include <atomic>
#include <bit>
#include <cmath>

#include "accel/traverse/inflight/inflight_ray.h"
#include "accel/traverse/single.h"
#include "core/simd_order.h"

namespace oktett {

/// The children of a node that a ray meets and has yet to visit. A ray waits for each node and block in turn,
/// so its next one must be known early: the nearest child is a minimum over lanes, and that of those that
/// wait is found before the ray comes back to them. Query::any takes children as they come.
template <Query Q, class A>
class Siblings {
 public:
  using F = Simd<float, BvhNode::kWidth, A>;

  /// Of the children of `node`, numbered `ref`, in `given`, not empty, the nearest is returned and the others
  /// wait. `met` is `given` as bits.
  OKTETT_INLINE NodeRef set(NodeRef ref, const BvhNode& node, const F& near, const typename F::M& given,
                            unsigned met) {
    node_ = ref.bits();
    order_ = LaneOrder<A>(near, given);
    const auto nearest = order_.least();
    order_.take(nearest);
    left_ = __builtin_popcount(met) - 1;
    find_next(node);
    return NodeRef::from_bits(nearest.pick(node.child_bits()));
  }

  OKTETT_INLINE bool empty() const { return left_ == 0; }
  /// Nothing of what waits is met before `limit`.
  OKTETT_INLINE bool beyond(float limit) const {
    // The last three bits of the key are the number of a lane.
    return key_ > (std::bit_cast<std::uint32_t>(limit * kSlabRelativeSlack) | 7);
  }
  /// The one to visit next, unless it is empty.
  OKTETT_INLINE NodeRef next() const { return next_; }
  OKTETT_INLINE NodeRef take(const BvhNode* nodes) {
    const NodeRef taken = next_;
    --left_;
    find_next(nodes[node_]);
    return taken;
  }

 private:
  OKTETT_INLINE void find_next(const BvhNode& node) {
    const auto least = order_.least();
    next_ = NodeRef::from_bits(least.pick(node.child_bits())), key_ = least.key();
    order_.take(least);
  }

  LaneOrder<A> order_;  ///< of those behind the next
  std::uint32_t node_, key_;
  NodeRef next_;
  int left_;
};

template <class A>
class Siblings<Query::any, A> {
 public:
  using F = Simd<float, BvhNode::kWidth, A>;

  OKTETT_INLINE NodeRef set(NodeRef ref, const BvhNode& node, const F&, const typename F::M&, unsigned met) {
    node_ = ref.bits(), lanes_ = met;
    next_ = node.child[__builtin_ctz(met)];
    return take(node);
  }

  OKTETT_INLINE bool empty() const { return lanes_ == 0; }
  OKTETT_INLINE bool beyond(float) const { return false; }
  OKTETT_INLINE NodeRef next() const { return next_; }
  OKTETT_INLINE NodeRef take(const BvhNode* nodes) { return take(nodes[node_]); }

 private:
  OKTETT_INLINE NodeRef take(const BvhNode& node) {
    const NodeRef taken = next_;
    lanes_ &= lanes_ - 1;
    next_ = node.child[__builtin_ctz(lanes_ | 1u << (BvhNode::kWidth - 1))];
    return taken;
  }

  std::uint32_t node_;
  unsigned lanes_;
  NodeRef next_;
};

/// A ray and its way through a tree.
template <Query Q, class A>
class SoloTraversal {
 public:
  OKTETT_INLINE SoloTraversal(const Accel& accel, const Ray& ray) : accel_(accel), ray_(ray) {
    const auto lanes = [](const Vec3f& p) { return V::of(p.x, p.y, p.z, 0.0f); };
    const V o = lanes(ray.origin), unflushed = lanes(ray.direction), big(std::numeric_limits<float>::max());
    const V d = select(abs(unflushed) < V(std::numeric_limits<float>::min()), V(0.0f), unflushed);
    const float extent = box_extent(accel.bounds);
    const float d_max = horizontal_max(abs(d)), span = horizontal_max(abs(o)) + extent;
    const unsigned finite = bits((abs(o) <= big) & (abs(d) <= big));
    tame_ = finite == 0xf && 0 <= ray.tmin && ray.tmin < ray.tmax && kChunkMinExtent <= span &&
            span <= kClassifyMaxExtent && 1 / kClassifyMaxDirection <= d_max &&
            d_max <= kClassifyMaxDirection;
    const V reach = V(span) / V(d_max);
    const SlabLines<V> line = slab_lines(o, d, reach, V(d_max * kChunkMinComponent), V(extent));
    line.inverse.store(inv_), line.near_shift.store(near_shift_), line.far_shift.store(far_shift_);
    chunk_slack(reach).store(slack_);
    d.store(d_), d.store(d_ + 3), o.store(o_), o.store(o_ + 3);
    // The first axis of the greatest component; without branches, which random directions make slow.
    z_axis_ = __builtin_ctz(bits(abs(d) == V(d_max)) | 8);
    inv_dz_ = 1.0 / static_cast<double>(d_[z_axis_]);
    shear_x_ = static_cast<double>(d_[z_axis_ + 1]) * inv_dz_;
    shear_y_ = static_cast<double>(d_[z_axis_ + 2]) * inv_dz_;
    negative_ = bits(line.inverse < V(0.0f));
    weight_scale_ = d_max * kWeightError, det_scale_ = d_max * kVolumeError;
    tmax_ = hit_lo_ = ray.tmax;
  }

  OKTETT_INLINE Hit run() {
    if (OKTETT_UNLIKELY(!tame_)) return trace_exact<Q, A>(accel_, ray_);
    if (OKTETT_LIKELY(accel_.unbounded.empty()) || !unbounded()) traverse();
    if (candidate_ == kNoCandidate) return {};
    if constexpr (Q == Query::any) return {ray_.tmax, 0, 0, 0, kNoId};
    return candidate_ == kDecidedHit ? state_.hit(0) : decide();
  }

 private:
  static constexpr int kBlock = TriangleBlock::kSize;
  using F = Simd<float, kBlock, A>;
  using V = Simd<float, 4, A>;

  OKTETT_NOINLINE bool unbounded() {
    for (const LeafEntry& leaf : accel_.unbounded) table_leaf_single<Q>(accel_, leaf, exact_state());
    adopt();
    return found();
  }

  OKTETT_INLINE bool found() const { return Q == Query::any && candidate_ == kDecidedHit; }

  OKTETT_INLINE void traverse() {
    // With room for an entry that is written, but does not count, as the ray meets one child of the node
    // only.
    Siblings<Q, A> waiting[kMaxDepth + 1];
    int top = -1;
    std::uint32_t near_row[3];
    alignas(64) float lines[9][BvhNode::kWidth];
    for (std::size_t k = 0; k < 3; ++k) {
      F(inv_[k]).store(lines[k]), F(near_shift_[k]).store(lines[3 + k]), F(far_shift_[k]).store(lines[6 + k]);
      near_row[k] = near_offset(static_cast<std::uint32_t>(k), negative_ >> k & 1);
    }
    // Adding zero turns -0 into 0, because near distances are sorted by their bits.
    const F tmin(ray_.tmin + 0.0f);
    const BvhNode* nodes = accel_.nodes.data();
    const TreeBytes bytes(accel_);
    float limit = tmax_ + slack_[0];
    NodeRef ref = accel_.root;
    if (ref.is_none()) return;
    for (;;) {
      if (!ref.is_leaf()) {
        // Loaded for each way down, so that they are in registers there: the test of a block needs all of
        // these, and compilers would leave the lines in memory for good.
        std::atomic_signal_fence(std::memory_order_acq_rel);
        const auto load = [&](int k) {
          return std::array{F::load(lines[k]), F::load(lines[k + 1]), F::load(lines[k + 2])};
        };
        const std::array<F, 3> inv = load(0), near_shift = load(3), far_shift = load(6);
        const F end(limit);
        unsigned met;
        do {
          const BvhNode& node = nodes[ref.bits()];
          F near;
          const F far = fused_interval<F>(node, near_row, inv, near_shift, far_shift, tmin, end, near);
          const auto given = near <= far;
          met = bits(given);
          if (met == 0) break;
          Siblings<Q, A>& here = waiting[top + 1];
          ref = here.set(ref, node, near, given, met);
          bytes.prefetch(here.empty() ? ref : here.next());
          top += !here.empty();
        } while (!ref.is_leaf());
        if (met != 0) continue;
      } else if (ref.is_triangles()) {
        if (OKTETT_UNLIKELY(leaf(ref))) {
          if (found()) return;
          limit = tmax_ + slack_[0];
        }
      } else {
        table_leaf_single<Q>(accel_, accel_.leaves[ref.table_index()], exact_state());
        adopt();
        if (found()) return;
        limit = tmax_ + slack_[0];
      }
      while (top >= 0 && waiting[top].beyond(limit)) --top;
      if (top < 0) return;
      ref = waiting[top].take(nodes);
      top -= waiting[top].empty();
    }
  }

  /// Tests a block of triangles; returns true if there is a new nearest hit.
  OKTETT_INLINE bool leaf(NodeRef ref) {
    const auto guess = guess_triangle(Vec3<F>{F(o_[0]), F(o_[1]), F(o_[2])},
                                      Vec3<F>{F(d_[0]), F(d_[1]), F(d_[2])}, F(weight_scale_), F(det_scale_),
                                      filter_triangle(load_triangles<F>(accel_.blocks[ref.block()])));
    const unsigned present = (2u << (ref.triangle_count() - 1)) - 1;
    const unsigned maybe = bits(maybe_hit(guess, F(tmax_))) & present;
    return OKTETT_UNLIKELY(maybe != 0) && take(ref, guess, maybe);
  }

  /// The same for the triangles that the filter did not reject, the bits of `maybe`.
  OKTETT_INLINE bool take(NodeRef ref, const TriangleGuess<F>& guess, unsigned maybe) {
    const TriangleBlock& block = accel_.blocks[ref.block()];
    const auto repeated = [&] {
      if (!accel_.pieces) return 0u;
      return repeated_lane<A>(candidate_item(accel_.blocks.data(), candidate_, state_, kNoId), block);
    };
    const auto interval = [&] { return hit_interval(guess, F(ray_.tmin), F(tmax_)); };
    SureHit hit;
    switch (judge_block<Q, A>(guess, maybe, 0, block, o_, d_, true, hit_lo_, repeated, interval, hit)) {
      case BlockVerdict::missed:
        return false;
      case BlockVerdict::hit:
        candidate_ = kDecidedHit;
        return true;
      case BlockVerdict::nearest:
        candidate_ = ref.block() * kBlock + static_cast<std::uint32_t>(hit.lane);
        hit_lo_ = hit.lo, tmax_ = hit.hi;
        return true;
      case BlockVerdict::open:
        break;
    }
    leaf_triangles_single(block, ref.triangle_count(), exact_state());
    return adopt();
  }

  /// The state for exact tests, in which the candidate has been decided.
  OKTETT_NOINLINE RayState<1, A>& exact_state() {
    if (!has_state_) state_.set(ray_, accel_.bounds);
    has_state_ = true;
    if (candidate_ < kDecidedHit) {
      const Hit h = decide();
      if (h.valid()) accept_hit(state_, 0, h.t, h.u, h.v, h.item, h.instance);
    }
    return state_;
  }

  /// Decides the candidate.
  OKTETT_INLINE Hit decide() const {
    using D = Simd<double, V::kWidth, A>;
    const TriangleBlock& block = accel_.blocks[candidate_ / kBlock];
    const std::uint32_t lane = candidate_ % kBlock;
    const auto origin = [&](int axis) { return D(static_cast<double>(o_[axis])); };
    HitLanes<V> h;
    const unsigned met = bits(decide_watertight(
        ShearLanes<D>{{origin(z_axis_ + 1), origin(z_axis_ + 2), origin(z_axis_)},
                      D(inv_dz_),
                      D(shear_x_),
                      D(shear_y_)},
        broadcast_triangle<V>(block, static_cast<int>(lane), z_axis_), V(ray_.tmin), V(ray_.tmax), h));
    if (OKTETT_UNLIKELY(met == 0)) return {};
    float t[V::kWidth], u[V::kWidth], v[V::kWidth];
    h.t.store(t), h.u.store(u), h.v.store(v);
    return {t[0], u[0], v[0], block.item[lane], kNoId};
  }

  OKTETT_INLINE bool adopt() {
    if (state_.item[0] == kNoId) return false;
    candidate_ = kDecidedHit;
    hit_lo_ = tmax_ = state_.tmax[0];
    return true;
  }

  const Accel& accel_;
  const Ray& ray_;
  float inv_[4], near_shift_[4], far_shift_[4], slack_[4];
  float d_[7],
      o_[7];  ///< direction and origin, twice: from each axis on, the next two follow in cyclic order
  unsigned negative_;
  int z_axis_;
  double inv_dz_, shear_x_, shear_y_;
  bool tame_, has_state_ = false;
  float weight_scale_, det_scale_, tmax_, hit_lo_;
  std::uint32_t candidate_ = kNoCandidate;
  RayState<1, A> state_;
};

}  // namespace oktett
