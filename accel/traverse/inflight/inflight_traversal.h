#pragma once
/// \file The steps of many single rays in flight: each step takes one ray through one node or one leaf,
/// prefetches the memory of its next step and goes on with another ray, which hides the latency of cache
/// misses. The rays share nothing, so it does not matter whether they are coherent. A ray that reaches an
/// instance goes inside and stays in flight (accel/traverse/inflight/enter_instance.h).
///
/// Triangles are classified in float (kernels/triangle/triangle_classify.h). A triangle that is surely hit,
/// and surely nearer than the nearest hit so far, becomes the ray's candidate hit, which is decided after the
/// ray is finished; only a triangle that the classification leaves open is decided at once.

#include <algorithm>

#include "accel/traverse/inflight/block_lanes.h"
#include "accel/traverse/inflight/enter_instance.h"
#include "accel/traverse/inflight/inflight_queues.h"
#include "accel/traverse/inflight/leaf_group.h"
#include "accel/traverse/inflight/pending_hits.h"

namespace oktett {

/// Leaves are visited when this many rays wait at leaves, or when no ray is at a node.
inline constexpr int kLeafThreshold = 8;

/// Which trees the rays of an InflightTraversal are in.
enum class InflightTrees {
  small,      ///< a tree without instances that is in the caches
  large,      ///< the same, but each ray prefetches the memory of its next step
  instances,  ///< a tree with instances and what the instances show; also prefetches
  inside,     ///< what the instances of a tree show, and not the tree itself; also prefetches
};

/// The steps of rays in flight through `accel`. `Derived` starts the rays, and has a member function
/// finish(ray, tail) that takes the result of a finished ray and may start another in its place.
template <class Derived, Query Q, class A, InflightTrees kTrees>
class InflightTraversal {
 protected:
  explicit InflightTraversal(const Accel& accel) : accel_(accel) {}

  /// Some steps of the rays in the queues, at least one of which is not empty.
  OKTETT_INLINE void advance() {
    node_round();
    if (queues_.leaves.size() >= kLeafThreshold || queues_.nodes.size() == 0) leaf_round();
    if (queues_.others.size() >= kLeafThreshold || queues_.nodes.size() + queues_.leaves.size() == 0)
      other_round();
  }

  /// Rays may be in an instance; those that are not may go into one.
  static constexpr bool kInstances = kTrees == InflightTrees::instances || kTrees == InflightTrees::inside;
  static constexpr bool kEnter = kTrees == InflightTrees::instances;
  static constexpr bool kPrefetch = kTrees != InflightTrees::small;
  static constexpr int kBlock = TriangleBlock::kSize;
  static constexpr int kChunk = std::is_same_v<A, Avx512Isa> ? 16 : 8;
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

  /// One ray against a leaf of closed-form shapes outside instances. Needs less than exact_state() sets.
  template <class S>
  OKTETT_INLINE void shape_leaf(const typename S::Pool& pool, const LeafEntry& leaf, InflightRay& ray) {
    constexpr int N = kShapeLanes<S>;
    using F = Simd<float, N, A>;
    using D = Simd<double, N, A>;
    for (int k = 0; k < leaf.count; k += N) {
      const RayLanes<F> lanes{{F(ray.o[0]), F(ray.o[1]), F(ray.o[2])},
                              {F(ray.d[0]), F(ray.d[1]), F(ray.d[2])},
                              F(ray.tmin),
                              F(ray.tmax)};
      HitLanes<F> hit;
      const std::size_t first = leaf.begin + static_cast<std::size_t>(k);
      const auto found_here = first_root<S>(lanes, to_double(lanes), S::template load<D>(pool, first), hit);
      unsigned met = bits(found_here) & ((2u << (std::min(leaf.count - k, N) - 1)) - 1);
      if (met == 0) continue;
      alignas(64) float t[N];
      hit.t.store(t);
      for (; met != 0; met &= met - 1) {
        const int i = __builtin_ctz(met);
        if (t[i] <= ray.tmax)
          keep_hit(ray, {t[i], 0, 0, pool.item[first + static_cast<std::size_t>(i)], kNoId});
        if (Q == Query::any) return;
      }
    }
  }

  /// Tests the ray's block of triangles exactly.
  OKTETT_NOINLINE void decide_leaf(InflightRay& ray) {
    const NodeRef leaf = ray.current;
    exact_in(ray.in.instance, exact_state(ray), [&](const Accel& tree, RayState<1, A>& state) {
      leaf_triangles_single(tree.blocks[leaf.block()], leaf.triangle_count(), state);
    });
    adopt(ray);
  }

  /// Rays that are finished, at a leaf of the table, or on their way out of an instance.
  OKTETT_NOINLINE void other_round() {
    Tails tail = queues_.tails();
    SortedOthers rays(queues_.others.head, tail.other);
    queues_.others.head = tail.other;
    if constexpr (kEnter)
      for (InflightRay** at = rays.at_leaf; at != rays.at_leaf_end; ++at) prefetch_instance(accel_, **at);
    for (InflightRay** at = rays.finished; at != rays.finished_end; ++at) {
      static_cast<Derived*>(this)->finish(**at, tail);
    }
    if constexpr (kEnter)
      for (InflightRay** at = rays.leaving; at != rays.leaving_end; ++at) leave(**at, tail);
    for (InflightRay** at = rays.at_leaf; at != rays.at_leaf_end;) {
      const int count = group_at_leaf(at, rays.at_leaf_end, tail);
      if (count == 0) alone_at_leaf(**at, tail);
      at += std::max(count, 1);
    }
    if constexpr (kEnter) go_inside(tail);
    queues_.keep(tail);
  }

  /// Tests rays at the leaf of *begin together, if that pays, and returns how many; these are moved to
  /// `begin`.
  OKTETT_INLINE int group_at_leaf(InflightRay** begin, InflightRay** end, Tails& tail) {
    if (kInstances && (*begin)->in.instance != kNoInstance) return 0;
    const LeafEntry& leaf = accel_.leaves[(*begin)->current.table_index()];
    if (is_exact(leaf.kind)) {
      const int count = rays_at_leaf<kInstances>(begin, end, ExactCode<A>::kLanes);
      exact_together(leaf, begin, count, tail);
      return count;
    }
    const int least = least_group(leaf);
    if (end - begin < least) return 0;
    const int count = rays_at_leaf<kInstances>(begin, end, kGroupRays);
    if (count < least) return 0;
    shapes_together(leaf, begin, count, tail);
    return count;
  }

  OKTETT_INLINE void exact_together(const LeafEntry& leaf, InflightRay* const* rays, int count, Tails& tail) {
    const auto r = gather_rays<ExactCode<A>::kLanes, A>(rays_, rays, count);
    RayState<ExactCode<A>::kLanes, A> state;
    const unsigned lanes = state.set_rays(r.o, r.d, r.tmin, r.tmax) & ((1u << count) - 1);
    if (lanes != 0) leaf_exact(accel_, leaf, state, lanes);
    take_hits(rays, count, found_lanes(state, lanes), state, tail);
  }

  /// Rays at one leaf of closed-form shapes or combinations.
  OKTETT_NOINLINE void shapes_together(const LeafEntry& leaf, InflightRay* const* rays, int count,
                                       Tails& tail) {
    const auto r = gather_rays<kGroupRays, A>(rays_, rays, count);
    RayState<kGroupRays, A> state;
    const unsigned lanes = state.set(r.o, r.d, r.tmin, r.tmax, accel_.bounds) & ((1u << count) - 1);
    if (lanes != 0) table_leaf_packet<Q>(accel_, leaf, state, lanes);
    take_hits(rays, count, found_lanes(state, lanes), state, tail);
  }

  /// Gives the rays in `met` their hits from `state`, and takes each ray to its next node or leaf.
  template <int N>
  OKTETT_INLINE void take_hits(InflightRay* const* rays, int count, unsigned met, const RayState<N, A>& state,
                               Tails& tail) {
    for (int i = 0; i < count; ++i) {
      InflightRay& ray = *rays[i];
      if ((met >> i & 1) != 0) {
        if (ray.candidate < kDecidedHit) {
          // The candidate is decided only now, so the hit may turn out to be no nearer.
          accept_hit(exact_state(ray), 0, state.tmax[i], state.u[i], state.v[i], state.item[i],
                     state.path[i]);
          adopt(ray);
        } else {
          keep_hit(ray, state.hit(i));
        }
      }
      pop(ray, tail);
    }
  }

  OKTETT_INLINE void alone_at_leaf(InflightRay& ray, Tails& tail) {
    if (at_shapes(ray))
      pop(ray, tail);
    else
      table_leaf(ray, tail);
  }

  /// Tests the ray if its leaf holds spheres and its hit so far is decided.
  OKTETT_INLINE bool at_shapes(InflightRay& ray) {
    if (ray.candidate < kDecidedHit || (kInstances && ray.in.instance != kNoInstance)) return false;
    const LeafEntry& leaf = accel_.leaves[ray.current.table_index()];
    if (leaf.kind != Kind::sphere) return false;
    shape_leaf<Sphere>(std::get<Sphere::Pool>(accel_.pools), leaf, ray);
    return true;
  }

  OKTETT_INLINE void table_leaf(InflightRay& ray, Tails& tail) {
    const NodeRef ref = ray.current;
    if constexpr (kEnter) {
      const LeafEntry& leaf = ray.in.accel->leaves[ref.table_index()];
      if (ray.in.instance == kNoInstance && holds_instances(leaf.kind)) {
        ray.in.next = first_instance(leaf), ray.in.end = ray.in.next + leaf.count;
        outer_[&ray - inflight_] = ray;
        return add_entering(ray, tail);
      }
    }
    exact_in(ray.in.instance, exact_state(ray), [&](const Accel& tree, RayState<1, A>& state) {
      table_leaf_single<Q>(tree, tree.leaves[ref.table_index()], state);
    });
    adopt(ray);
    pop(ray, tail);
  }

  /// Takes the ray into the next instance of its leaf, or, after the last one, out of it.
  OKTETT_INLINE void leave(InflightRay& ray, Tails& tail) {
    if (ray.in.next != ray.in.end) return add_entering(ray, tail);
    leave_instance(ray, outer_[&ray - inflight_], accel_);
    pop(ray, tail);
  }

  OKTETT_INLINE void add_entering(InflightRay& ray, Tails& tail) {
    if (entering_.add(ray, outer_[&ray - inflight_], ray.in.next++, accel_)) go_inside(tail);
  }

  /// Takes the rays in `entering_` into their instances, or tests them exactly there and then lets them
  /// leave.
  OKTETT_INLINE void go_inside(Tails& tail) {
    const auto stay = [&](InflightRay& ray, std::uint32_t number) {
      with_instance(accel_, number, [&](const auto& instance, const Accel& child) {
        instance_single<Q>(instance, child, exact_state(ray), IgnoreSteps{});
      });
      adopt(ray);
      if (Q != Query::any || ray.candidate == kNoCandidate) ray.push(NodeRef::way_out(), -1);
      pop(ray, tail);
    };
    const auto enter = [&](InflightRay& ray, NodeRef root) {
      ray.current = root;
      enqueue(ray, root, tail);
    };
    const auto miss = [&](InflightRay& ray) {
      if (ray.in.next != ray.in.end)
        ray.push(NodeRef::way_out(), -1);
      else if (ray.in.instance != kNoInstance)
        leave_instance(ray, outer_[&ray - inflight_], accel_);
      pop(ray, tail);
    };
    entering_.go(accel_, enter, miss, stay);
  }

  const Accel& accel_;
  RaySpan rays_;
  const TreeBytes bytes_{accel_};
  InflightQueues queues_;
  PendingHits<kChunk, A, kInstances> pending_;
  RayChunk<kChunk, A> chunk_;
  InflightRay inflight_[kInflightRays];
  RayState<1, A> states_[kInflightRays];
  InflightHead outer_[kEnter ? kInflightRays : 1];
  EnteringRays<kEnter ? kChunk : 1, A> entering_;
};

}  // namespace oktett
