#pragma once
/// \file Rays in flight through nodes and blocks of triangles: each step takes one ray through one node or
/// one block, prefetches the memory of its next step and goes on with another ray, which hides the latency of
/// cache misses. The rays share nothing, so it does not matter whether they are coherent.
///
/// Triangles are classified in float (kernels/triangle/triangle_classify.h). A triangle that is surely hit,
/// and surely nearer than the nearest hit so far, becomes the ray's candidate hit, which is decided after the
/// ray is finished; only a triangle that the classification leaves open is decided at once.

#include <algorithm>

#include "accel/traverse/inflight/block_lanes.h"
#include "accel/traverse/inflight/enter_instance.h"
#include "accel/traverse/inflight/inflight_queues.h"
#include "accel/traverse/inflight/pending_hits.h"

namespace oktett {

/// Which trees rays in flight are in.
enum class InflightTrees {
  small,      ///< a tree without instances that is in the caches
  large,      ///< the same, but each ray prefetches the memory of its next step
  instances,  ///< a tree with instances and what the instances show; also prefetches
  inside,     ///< what the instances of a tree show, and not the tree itself; also prefetches
};

/// The rays in flight of a traversal of `accel`, and their steps through nodes and blocks of triangles.
template <Query Q, class A, InflightTrees kTrees>
class TriangleSteps {
 protected:
  explicit TriangleSteps(const Accel& accel) : accel_(accel) {}

  /// Rays may be in an instance; those that are not may go into one.
  static constexpr bool kInstances = kTrees == InflightTrees::instances || kTrees == InflightTrees::inside;
  static constexpr bool kEnter = kTrees == InflightTrees::instances;
  static constexpr bool kPrefetch = kTrees != InflightTrees::small;
  static constexpr int kBlock = TriangleBlock::kSize;
  static constexpr int kChunk = kChunkRays<A>;
  static constexpr int kLeafRays = kBlockRays<A>;

  using Tails = InflightQueues::Tails;

  /// Queues `ray` for the kind of step that `ref` needs, and prefetches the node or block. For a finished ray
  /// the prefetched address means nothing.
  OKTETT_INLINE void enqueue(InflightRay& ray, NodeRef ref, Tails& t) const {
    if constexpr (kPrefetch) (kInstances ? ray.in.bytes : bytes_).prefetch(ref);
    InflightQueues::enqueue(ray, ref, t);
  }

  OKTETT_INLINE void pop(InflightRay& ray, Tails& t) {
    const NodeRef ref = NodeRef::from_bits(ray.ref[--ray.size]);
    ray.current = ref;
    enqueue(ray, ref, t);
  }

  /// The nodes and blocks of the tree that the ray is in.
  OKTETT_INLINE const BvhNode* nodes(const InflightRay& ray) const {
    return kInstances ? ray.in.bytes.nodes() : accel_.nodes.data();
  }
  OKTETT_INLINE const TriangleBlock* blocks(const InflightRay& ray) const {
    return kInstances ? ray.in.bytes.blocks() : accel_.blocks.data();
  }

  void node_round() {
    Tails t = queues_.tails();
    InflightRay** at = queues_.nodes.head;
    for (InflightRay** const end = at + std::max(queues_.nodes.size(), kRoundSteps);
         at != t.node && at != end; ++at)
      enqueue(**at, step_node<Q, A>(**at, nodes(**at)[(*at)->current.bits()]), t);
    queues_.nodes.head = at;
    queues_.keep(t);
  }

  void leaf_round() {
    Tails t = queues_.tails();
    InflightRay** at = queues_.leaves.head;
    InflightRay** const end = t.leaf;
    for (; end - at >= kLeafRays; at += kLeafRays) leaf_step<kLeafRays>(at, t);
    for (; at != end; ++at) leaf_step<1>(at, t);
    queues_.leaves.head = at;
    queues_.keep(t);
  }

  /// N rays, each against its own block of triangles.
  template <int N>
  OKTETT_INLINE void leaf_step(InflightRay* const* rays, Tails& tail) {
    using F = BlockLanes<N, A>;
    const auto ray = [&](int j) -> const InflightRay& { return *rays[j]; };
    const auto guess = guess_blocks<N, A>(
        ray, [&](int j) -> const TriangleBlock& { return blocks(ray(j))[ray(j).current.block()]; });
    const F tmax = spread_blocks<N, A>([&](int j) { return ray(j).tmax; });
    unsigned present = 0;
    for (int j = 0; j < N; ++j)
      present |= ((2u << (rays[j]->current.triangle_count() - 1)) - 1) << (j * kBlock);
    const unsigned maybe = bits(maybe_hit(guess, tmax)) & present;
    if (OKTETT_UNLIKELY(maybe != 0)) {
      const HitInterval<F> h =
          hit_interval(guess, spread_blocks<N, A>([&](int j) { return ray(j).tmin; }), tmax);
      for (int j = 0; j < N; ++j) take(*rays[j], guess, h, maybe, j * kBlock);
    }
    for (int j = 0; j < N; ++j) pop(*rays[j], tail);
  }

  /// Takes the triangles of the ray's block that the filter did not reject, the bits of `maybe`. The block is
  /// in lanes `first`, `first` + 1, ... of `guess`, `h` and `maybe`.
  template <class F>
  OKTETT_INLINE void take(InflightRay& ray, const TriangleGuess<F>& guess, const HitInterval<F>& h,
                          unsigned maybe, int first) {
    maybe = maybe >> first & ((1u << kBlock) - 1);
    if (maybe != 0 && (kInstances ? *ray.in.accel : accel_).pieces)
      maybe &= ~repeated_lane<A>(repeated_item(ray), blocks(ray)[ray.current.block()]);
    const unsigned near = bits(guess.t <= guess.t_error) >> first & maybe;
    if (OKTETT_UNLIKELY(near != 0 && ray.tmin >= 0))
      maybe &= ~(near & behind_origin<A>(ray.o, ray.d, blocks(ray)[ray.current.block()]));
    if (maybe == 0) return;
    const unsigned sure = bits(h.sure) >> first & maybe;
    if (sure != 0) {
      if constexpr (Q == Query::any) return found(ray);
      const SureHit hit = nearest_sure(h, sure, first);
      if ((maybe & (maybe - 1)) != 0) maybe &= bits(maybe_hit(guess, F(hit.hi))) >> first;
      if (maybe == 1u << hit.lane && hit.hi < ray.hit_lo) {
        ray.candidate = ray.current.block() * kBlock + static_cast<std::uint32_t>(hit.lane);
        if constexpr (kInstances) ray.in.candidate_instance = ray.in.instance;
        ray.hit_lo = hit.lo;
        return shorten<A>(ray, hit.hi);
      }
    }
    decide_leaf(ray);
  }

  /// The item of the ray's nearest hit so far, if it is a triangle of the tree that the ray is in, else
  /// kNoId.
  OKTETT_INLINE std::uint32_t repeated_item(const InflightRay& ray) const {
    std::uint32_t path = kNoId;
    if constexpr (kInstances) {
      if (ray.candidate < kDecidedHit && ray.in.candidate_instance != ray.in.instance) return kNoId;
      if (ray.in.instance != kNoInstance)
        with_instance(accel_, ray.in.instance,
                      [&](const auto& instance, const Accel&) { path = outer_path(instance, kNoId); });
    }
    return candidate_item(blocks(ray), ray.candidate, states_[&ray - inflight_], path);
  }

  /// For Query::any: the ray has hit something and is finished.
  OKTETT_INLINE void found(InflightRay& ray) {
    ray.candidate = kDecidedHit;
    ray.size = 1;
  }

  /// The ray's state for exact tests, in which its candidate has been decided.
  OKTETT_NOINLINE RayState<1, A>& exact_state(InflightRay& ray) {
    RayState<1, A>& r = states_[&ray - inflight_];
    if (ray.has_state == 0) {
      const Hit nearest = ray.candidate == kDecidedHit ? r.hit(0) : Hit{};
      Ray whole = rays_[ray.index];
      whole.tmax = ray.tmax;
      r.set(whole, accel_.bounds);
      r.set_hit(0, nearest);
      ray.has_state = 1;
    }
    if (ray.candidate < kDecidedHit)
      exact_in(ray.in.candidate_instance, r, [&](const Accel& tree, RayState<1, A>& state) {
        leaf_triangles_single(tree.blocks[ray.candidate / kBlock],
                              static_cast<int>(ray.candidate % kBlock) + 1, state);
      });
    return r;
  }

  /// Calls f(tree, state) for what an instance shows (kNoInstance: the whole structure) and the state there
  /// of a ray with state `r`; `r` takes over the hit.
  template <class Function>
  OKTETT_INLINE void exact_in(std::uint32_t number, RayState<1, A>& r, Function&& f) const {
    if constexpr (kInstances)
      if (number != kNoInstance)
        return with_instance(accel_, number, [&](const auto& instance, const Accel& child) {
          inside_instance(instance, child, r, [&](RayState<1, A>& state) { f(child, state); });
        });
    f(accel_, r);
  }

  /// Takes over the nearest hit from the exact tests.
  OKTETT_INLINE void adopt(InflightRay& ray) {
    const RayState<1, A>& r = states_[&ray - inflight_];
    if (r.item[0] == kNoId) return;
    if constexpr (Q == Query::any) return found(ray);
    ray.candidate = kDecidedHit;
    ray.hit_lo = r.tmax[0];
    shorten<A>(ray, r.tmax[0]);
  }

  /// Keeps a hit in no instance of a ray without an undecided candidate, if it is the nearest so far.
  OKTETT_INLINE void keep_hit(InflightRay& ray, const Hit& hit) {
    if constexpr (Q == Query::any) return found(ray);
    RayState<1, A>& r = states_[&ray - inflight_];
    if (ray.candidate == kDecidedHit &&
        !(hit.t < ray.tmax || id_before(hit.instance, hit.item, r.path[0], r.item[0])))
      return;
    ray.candidate = kDecidedHit;
    r.set_hit(0, hit);
    ray.hit_lo = hit.t;
    shorten<A>(ray, hit.t);
  }

  /// Tests the ray's block of triangles exactly.
  OKTETT_NOINLINE void decide_leaf(InflightRay& ray) {
    const NodeRef leaf = ray.current;
    exact_in(ray.in.instance, exact_state(ray), [&](const Accel& tree, RayState<1, A>& state) {
      leaf_triangles_single(tree.blocks[leaf.block()], leaf.triangle_count(), state);
    });
    adopt(ray);
  }

  const Accel& accel_;
  RaySpan rays_;
  const TreeBytes bytes_{accel_};
  InflightQueues queues_;
  PendingHits<kChunk, A, kInstances> pending_;
  RayChunk<kChunk, A> chunk_;
  InflightRay inflight_[kInflightRays];
  RayState<1, A> states_[kInflightRays];
};

}  // namespace oktett
