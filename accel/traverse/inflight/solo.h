#pragma once
/// \file One ray by itself through the tree, with the float arithmetic of interleaved rays: triangles are
/// classified, and the nearest hit is decided when the ray is finished, or where hits are judged, at once.

#include <array>
#include <atomic>
#include <bit>
#include <cmath>

#include "accel/hit_judge.h"
#include "accel/traverse/all_hits.h"
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

/// A ray prepared for the slab test in fused form, and for triangles.
template <class A>
struct SoloRay {
  using V = Simd<float, 4, A>;

  float inv[4], near_shift[4], far_shift[4], slack[4];  ///< see RayChunk
  /// Direction and origin, twice: from each axis on, the next two follow in cyclic order.
  float d[7], o[7];
  float d_max;
  unsigned negative;
  int z_axis;
  double inv_dz, shear_x, shear_y;
  bool is_tame;  ///< see RayChunk

  /// Through what lies within `bounds`.
  OKTETT_INLINE SoloRay(const Ray& ray, const Box& bounds) {
    const auto lanes = [](const Vec3f& p) { return V::of(p.x, p.y, p.z, 0.0f); };
    const V origin = lanes(ray.origin), unflushed = lanes(ray.direction),
            big(std::numeric_limits<float>::max());
    const V direction = select(abs(unflushed) < V(std::numeric_limits<float>::min()), V(0.0f), unflushed);
    const float extent = box_extent(bounds), span = horizontal_max(abs(origin)) + extent;
    d_max = horizontal_max(abs(direction));
    const unsigned finite = bits((abs(origin) <= big) & (abs(direction) <= big));
    is_tame = finite == 0xf && 0 <= ray.tmin && ray.tmin < ray.tmax && kChunkMinExtent <= span &&
              span <= kClassifyMaxExtent && 1 / kClassifyMaxDirection <= d_max &&
              d_max <= kClassifyMaxDirection;
    const V reach = V(span) / V(d_max);
    const SlabLines<V> line = slab_lines(origin, direction, reach, V(d_max * kChunkMinComponent), V(extent));
    line.inverse.store(inv), line.near_shift.store(near_shift), line.far_shift.store(far_shift);
    chunk_slack(reach).store(slack);
    direction.store(d), direction.store(d + 3), origin.store(o), origin.store(o + 3);
    // The first axis of the greatest component; without branches, which random directions make slow.
    z_axis = __builtin_ctz(bits(abs(direction) == V(d_max)) | 8);
    inv_dz = 1.0 / static_cast<double>(d[z_axis]);
    shear_x = static_cast<double>(d[z_axis + 1]) * inv_dz;
    shear_y = static_cast<double>(d[z_axis + 2]) * inv_dz;
    negative = bits(line.inverse < V(0.0f));
  }

  /// The offset of the near planes of an axis in a node.
  OKTETT_INLINE std::uint32_t near_row(std::uint32_t axis) const {
    return near_offset(axis, negative >> axis & 1);
  }
};

/// The judge of what is outside of an instance, for hits inside.
template <class Instance, class A>
class InsideJudge final : public HitJudge {
 public:
  InsideJudge(HitJudge& outer, const Instance& instance) : outer_(outer), instance_(instance) {}
  bool offer(HitWithNormal* hits, int count) override {
    for (int i = 0; i < count; ++i) hits[i].instance = outer_path(instance_, hits[i].instance);
    return outer_.offer(hits, count);
  }
  float end() const override { return outer_.end(); }
  HitList& scratch() override { return outer_.scratch(); }

 private:
  HitJudge& outer_;
  const Instance& instance_;
};

/// Offers hits of a list one after the other. Returns whether one counts.
template <Query Q, class A>
bool offer_list(HitList& list, HitJudge& judge) {
  bool counts = false;
  for (std::size_t i = 0; i < list.size() && !(Q == Query::any && counts); ++i) {
    HitWithNormal hit{list[i].hit};
    counts |= hit.t <= judge.end() && judge.offer(&hit, 1);
  }
  return counts;
}

/// A ray and its way through a tree. `Judge` is HitJudge or NoJudge.
template <Query Q, class A, class Judge = NoJudge>
class SoloTraversal {
 public:
  OKTETT_INLINE SoloTraversal(const Accel& accel, const Ray& ray, Judge& judge)
      : accel_(accel), ray_(ray), judge_(judge), r_(ray, accel.bounds) {
    weight_scale_ = r_.d_max * kWeightError, det_scale_ = r_.d_max * kVolumeError;
    tmax_ = hit_lo_ = ray.tmax;
  }

  /// Whether the float arithmetic suffices for the ray; only then it may run.
  OKTETT_INLINE bool is_tame() const { return r_.is_tame; }

  /// What the ray hits; if hits are judged, no more than whether one counts.
  OKTETT_INLINE HitWithNormal run() {
    if (OKTETT_LIKELY(accel_.unbounded.empty()) || !unbounded()) traverse();
    if (candidate_ == kNoCandidate) return {};
    if constexpr (Q == Query::any || kJudged) return {{ray_.tmax, 0, 0, 0, kNoId}};
    if (candidate_ != kDecidedHit) return decide(candidate_);
    // Something that is in no instance may have been nearer.
    const Hit hit = state_.hit(0);
    return {hit, inside_.normal, inside_.has_normal && hit == static_cast<const Hit&>(inside_)};
  }

 private:
  static constexpr int kBlock = TriangleBlock::kSize;
  static constexpr bool kJudged = !std::is_same_v<Judge, NoJudge>;
  using F = Simd<float, kBlock, A>;
  using V = Simd<float, 4, A>;

  OKTETT_NOINLINE bool unbounded() {
    for (const LeafEntry& leaf : accel_.unbounded) table_leaf(leaf);
    return found();
  }

  OKTETT_INLINE void table_leaf(const LeafEntry& leaf) {
    if constexpr (kJudged) return offer_leaf(leaf);
    if (Q == Query::closest && holds_instances(leaf.kind))
      enter(leaf);
    else
      table_leaf_single<Q>(accel_, leaf, exact_state());
    adopt();
  }

  /// Goes through instances for the nearest hit.
  OKTETT_NOINLINE void enter(const LeafEntry& leaf) {
    RayState<1, A>& state = exact_state();
    each_instance(accel_, leaf, [&]<class Instance>(const Instance& instance, const Accel& child) {
      const HitWithNormal hit =
          trace_one_with_normal<A>(child, ray_inside<Instance, A>(instance, load_rays(state)));
      accept_inside(instance, state, hit);
      if (!hit.valid()) return true;
      HitWithNormal here = hit;
      here.instance = outer_path(instance, hit.instance);
      if (state.hit(0) == static_cast<const Hit&>(here)) inside_ = here;
      return true;
    });
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
      F(r_.inv[k]).store(lines[k]), F(r_.near_shift[k]).store(lines[3 + k]),
          F(r_.far_shift[k]).store(lines[6 + k]);
      near_row[k] = r_.near_row(static_cast<std::uint32_t>(k));
    }
    // Adding zero turns -0 into 0, because near distances are sorted by their bits.
    const F tmin(ray_.tmin + 0.0f);
    const BvhNode* nodes = accel_.nodes.data();
    const TreeBytes bytes(accel_);
    float limit = tmax_ + r_.slack[0];
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
          limit = tmax_ + r_.slack[0];
        }
      } else {
        table_leaf(accel_.leaves[ref.table_index()]);
        if (found()) return;
        limit = tmax_ + r_.slack[0];
      }
      while (top >= 0 && waiting[top].beyond(limit)) --top;
      if (top < 0) return;
      ref = waiting[top].take(nodes);
      top -= waiting[top].empty();
    }
  }

  /// Tests a block of triangles; returns true if there is a new nearest hit.
  OKTETT_INLINE bool leaf(NodeRef ref) {
    const auto guess =
        guess_triangle(Vec3<F>{F(r_.o[0]), F(r_.o[1]), F(r_.o[2])},
                       Vec3<F>{F(r_.d[0]), F(r_.d[1]), F(r_.d[2])}, F(weight_scale_), F(det_scale_),
                       filter_triangle(load_triangles<F>(accel_.triangles(ref.triangle_leaf()))));
    const unsigned present = (2u << (ref.triangle_count() - 1)) - 1;
    const unsigned maybe = bits(maybe_hit(guess, F(tmax_))) & present;
    if (OKTETT_LIKELY(maybe == 0)) return false;
    if constexpr (kJudged)
      return offer_block(ref.triangle_leaf(), maybe, bits(guess.t <= guess.t_error) & maybe);
    else
      return take(ref, guess, maybe);
  }

  // ---- Hits that are judged.

  /// Decides triangles of a block, the bits of `maybe`, and offers those that are hit. Of `near` the origin
  /// may lie behind.
  OKTETT_NOINLINE bool offer_block(std::uint32_t leaf, unsigned maybe, unsigned near) {
    if (near != 0) maybe &= ~(near & behind_origin<A>(r_.o, r_.d, accel_.triangles(leaf)));
    HitWithNormal hits[kBlock];
    int count = 0;
    for (; maybe != 0; maybe &= maybe - 1) {
      const HitWithNormal hit = decide(leaf * kBlock + static_cast<std::uint32_t>(__builtin_ctz(maybe)));
      if (hit.valid() && hit.t <= tmax_) hits[count++] = hit;
    }
    return count > 0 && judge_.offer(hits, count) && accept();
  }

  /// The same for a leaf of the table.
  OKTETT_NOINLINE void offer_leaf(const LeafEntry& leaf) {
    if (!has_state_) state_.set(ray_, accel_.bounds);
    has_state_ = true, state_.tmax[0] = tmax_;
    if (holds_instances(leaf.kind)) {
      each_instance(accel_, leaf, [&]<class Instance>(const Instance& instance, const Accel& child) {
        InsideJudge<Instance, A> inside(judge_, instance);
        if (judge_one<Q, A>(child, ray_inside<Instance, A>(instance, load_rays(state_)), inside))
          accept(), state_.tmax[0] = tmax_;
        return !found();
      });
      return;
    }
    HitList& list = judge_.scratch();
    list.shrink(0);
    collect_leaf(accel_, leaf, state_, list);
    if (offer_list<Q, A>(list, judge_)) accept();
  }

  OKTETT_INLINE bool accept() {
    candidate_ = kDecidedHit;
    tmax_ = judge_.end();
    return true;
  }

  // ---- Hits that count without being judged.

  /// The same for the triangles that the filter did not reject, the bits of `maybe`.
  OKTETT_INLINE bool take(NodeRef ref, const TriangleGuess<F>& guess, unsigned maybe) {
    const TriangleLeaf leaf = accel_.triangles(ref.triangle_leaf());
    const auto repeated = [&] {
      if (!accel_.pieces) return 0u;
      return repeated_lane<A>(candidate_item(accel_.blocks.data(), candidate_, state_, kNoId), leaf);
    };
    const auto interval = [&] { return hit_interval(guess, F(ray_.tmin), F(tmax_)); };
    SureHit hit;
    switch (judge_block<Q, A>(guess, maybe, 0, leaf, r_.o, r_.d, true, hit_lo_, repeated, interval, hit)) {
      case BlockVerdict::missed:
        return false;
      case BlockVerdict::hit:
        candidate_ = kDecidedHit;
        return true;
      case BlockVerdict::nearest:
        candidate_ = ref.triangle_leaf() * kBlock + static_cast<std::uint32_t>(hit.lane);
        hit_lo_ = hit.lo, tmax_ = hit.hi;
        return true;
      case BlockVerdict::open:
        break;
    }
    leaf_triangles_single(leaf, ref.triangle_count(), exact_state());
    return adopt();
  }

  /// The state for exact tests, in which the candidate has been decided.
  OKTETT_NOINLINE RayState<1, A>& exact_state() {
    if (!has_state_) state_.set(ray_, accel_.bounds);
    has_state_ = true;
    if (candidate_ < kDecidedHit) {
      const Hit h = decide(candidate_);
      if (h.valid()) accept_hit(state_, 0, h.t, h.u, h.v, h.item, h.instance);
    }
    return state_;
  }

  /// Decides a candidate.
  OKTETT_INLINE HitWithNormal decide(std::uint32_t candidate) const {
    using D = Simd<double, V::kWidth, A>;
    const TriangleLeaf leaf = accel_.triangles(candidate / kBlock);
    const std::uint32_t lane = candidate % kBlock;
    const auto origin = [&](int axis) { return D(static_cast<double>(r_.o[axis])); };
    HitLanes<V> h;
    const unsigned met = bits(decide_watertight(
        ShearLanes<D>{{origin(r_.z_axis + 1), origin(r_.z_axis + 2), origin(r_.z_axis)},
                      D(r_.inv_dz),
                      D(r_.shear_x),
                      D(r_.shear_y)},
        broadcast_triangle<V>(leaf, static_cast<int>(lane), r_.z_axis), V(ray_.tmin), V(ray_.tmax), h));
    if (OKTETT_UNLIKELY(met == 0)) return {};
    float t[V::kWidth], u[V::kWidth], v[V::kWidth];
    h.t.store(t), h.u.store(u), h.v.store(v);
    const TriangleLanes<Simd<float, 1, A>> corners =
        broadcast_triangle<Simd<float, 1, A>>(leaf, static_cast<int>(lane));
    const auto at = [](const Vec3<Simd<float, 1, A>>& p) {
      return Vec3f{p.x.part[0].v, p.y.part[0].v, p.z.part[0].v};
    };
    return {{t[0], u[0], v[0], leaf.item(lane), kNoId},
            triangle_normal(at(corners.a), at(corners.b), at(corners.c)),
            true};
  }

  OKTETT_INLINE bool adopt() {
    if (state_.item[0] == kNoId) return false;
    candidate_ = kDecidedHit;
    hit_lo_ = tmax_ = state_.tmax[0];
    return true;
  }

  const Accel& accel_;
  const Ray& ray_;
  [[no_unique_address]] std::conditional_t<kJudged, Judge&, Judge> judge_;
  const SoloRay<A> r_;
  bool has_state_ = false;
  float weight_scale_, det_scale_, tmax_, hit_lo_;
  std::uint32_t candidate_ = kNoCandidate;
  RayState<1, A> state_;
  HitWithNormal inside_;  ///< the last nearest hit in an instance
};

template <Query Q, class A>
OKTETT_NOINLINE bool judge_one(const Accel& accel, const Ray& ray, HitJudge& judge) {
  if constexpr (!std::is_same_v<A, ScalarIsa>) {
    SoloTraversal<Q, A, HitJudge> way(accel, ray, judge);
    if (OKTETT_LIKELY(way.is_tame())) return way.run().valid();
  }
  HitList& list = judge.scratch();
  list.shrink(0);
  trace_all_hits<A>(accel, ray, list);
  return offer_list<Q, A>(list, judge);
}

}  // namespace oktett
