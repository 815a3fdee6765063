#pragma once
/// \file Rays in flight through nodes and blocks of triangles: each step takes one ray through one node or
/// one block, prefetches the memory of its next step and goes on with another ray, which hides the latency of
/// cache misses. The rays share nothing, so it does not matter whether they are coherent.
///
/// Triangles are classified in float (kernels/triangle/triangle_classify.h). A triangle that is surely hit,
/// and surely nearer than the nearest hit so far, becomes the ray's candidate hit, which is decided after the
/// ray is finished; only a triangle that the classification leaves open is decided at once.

#include <algorithm>

#include "accel/traverse/inflight/decide_pairs.h"
#include "accel/traverse/inflight/inflight_ray.h"
#include "accel/traverse/single.h"

namespace oktett {

// ---- Rays in flight go into instances and out again. A ray in an instance is the transformed ray in the
// child's tree, with the distances of the ray outside, because directions are not normalised. So what the
// ray has on its stack, what it has hit and where it ends stay valid on both sides.

/// Prefetches the memory that describes the instance that the ray goes into, if it goes into one.
OKTETT_INLINE void prefetch_instance(const Accel& accel, const InflightRay& ray) {
  if (ray.in.instance != kNoInstance) return;
  const LeafEntry& leaf = accel.leaves[ray.current.table_index()];
  if (leaf.kind == Kind::instance_list) __builtin_prefetch(&accel.listed_instances[leaf.begin]);
  if (leaf.kind != Kind::instance) return;
  const InstanceItem& instance = accel.instances[leaf.begin];
  __builtin_prefetch(&instance), __builtin_prefetch(&instance.child);
}

/// Takes the ray out of its instance; `outer` is what it was outside, `accel` holds the instance.
OKTETT_INLINE void leave_instance(InflightRay& ray, const InflightHead& outer, const Accel& accel) {
  const InflightHead inside = ray;
  static_cast<InflightHead&>(ray) = outer;
  ray.set_end(inside.tmax);
  ray.hit_lo = inside.hit_lo, ray.candidate = inside.candidate, ray.has_state = inside.has_state;
  ray.size = inside.size;
  ray.in.set(accel);
}

/// Rays that go into an instance each, and are transformed together, one in each lane.
template <int W, class A>
class EnteringRays {
 public:
  int size() const { return size_; }
  InflightRay& ray(int i) const { return *ray_[i]; }

  /// Adds a ray that goes into instance `number` of `accel`; `outer` is the ray outside. Returns true if
  /// there is no room for another.
  OKTETT_INLINE bool add(InflightRay& ray, const InflightHead& outer, std::uint32_t number,
                         const Accel& accel) {
    const int i = size_++;
    ray_[i] = &ray, number_[i] = number;
    for (int k = 0; k < 3; ++k) o_[k][i] = outer.o[k], d_[k][i] = outer.d[k];
    tmin_[i] = ray.tmin, tmax_[i] = ray.tmax, slack_[i] = outer.slack;
    with_instance(accel, number, [&](const auto& instance, const Accel& child) {
      for (int k = 0; k < 12; ++k) to_child_[k][i] = static_cast<double>(instance.to_child[k]);
      for (int k = 0; k < 3; ++k) lo_[k][i] = child.bounds.lo[k], hi_[k][i] = child.bounds.hi[k];
      child_[i] = &child;
    });
    return size_ == W;
  }

  /// Takes the rays into their instances and calls enter(ray, root) for each. For rays that miss the bounds
  /// of what is inside, it calls miss(ray). Where a ray is not tame inside, where its stack might overflow,
  /// or where there are unbounded shapes, it calls stay(ray, number).
  template <class Enter, class Miss, class Stay>
  OKTETT_INLINE void go(const Accel& accel, Enter&& enter, Miss&& miss, Stay&& stay) {
    for (int i = size_; i < W; ++i) repeat_first(i);
    const auto vec = [](const float(&v)[3][W]) {
      return Vec3<F>{F::load(v[0]), F::load(v[1]), F::load(v[2])};
    };
    RayLanes<F> rays{vec(o_), vec(d_), F::load(tmin_), F::load(tmax_)};
    const RayLanes<F> outer = rays;
    transform_rays(*this, outer, rays.o, rays.d);
    const Vec3<F> lo = vec(lo_), hi = vec(hi_);
    chunk_.set(rays, (1u << size_) - 1, extent_of(lo, hi));
    const unsigned met = chunk_.meets(lo, hi);
    for (int i = 0; i < size_; ++i) {
      InflightRay& ray = *ray_[i];
      const Accel& child = *child_[i];
      if (OKTETT_UNLIKELY((chunk_.tame >> i & 1) == 0 || !child.unbounded.empty() ||
                          accel.stats.depth + child.stats.depth > kMaxDepth)) {
        stay(ray, number_[i]);
        continue;
      }
      if ((met >> i & 1) == 0) {
        miss(ray);
        continue;
      }
      set_lines(ray, chunk_, i);
      // The entries of the stack that were pushed outside must not be removed too early.
      ray.slack = std::max(ray.slack, slack_[i]);
      ray.set_end(ray.tmax);
      ray.in.accel = &child, ray.in.bytes = TreeBytes(child), ray.in.instance = number_[i];
      ray.push(NodeRef::way_out(), -1);
      enter(ray, child.root);
    }
    size_ = 0;
  }

  /// Entry k of the maps into the children, for transform_rays().
  OKTETT_INLINE Simd<double, W, A> map_entry(int k) const { return Simd<double, W, A>::load(to_child_[k]); }

 private:
  using F = Simd<float, W, A>;

  /// The greatest |coordinate| of a box each.
  static OKTETT_INLINE F extent_of(const Vec3<F>& lo, const Vec3<F>& hi) {
    const auto axis = [](const F& a, const F& b) { return max(abs(a), abs(b)); };
    return max(axis(lo.x, hi.x), max(axis(lo.y, hi.y), axis(lo.z, hi.z)));
  }

  OKTETT_INLINE void repeat_first(int i) {
    for (int k = 0; k < 3; ++k) o_[k][i] = o_[k][0], d_[k][i] = d_[k][0];
    tmin_[i] = tmin_[0], tmax_[i] = tmax_[0];
    for (int k = 0; k < 3; ++k) lo_[k][i] = lo_[k][0], hi_[k][i] = hi_[k][0];
    for (auto& row : to_child_) row[i] = row[0];
  }

  int size_ = 0;
  alignas(64) float o_[3][W], d_[3][W], tmin_[W], tmax_[W], slack_[W], lo_[3][W], hi_[3][W];
  alignas(64) double to_child_[12][W];
  InflightRay* ray_[W];
  const Accel* child_[W];
  std::uint32_t number_[W];
  RayChunk<W, A> chunk_;
};

// ---- The candidate hits of finished rays, which are decided together, one in each lane.

/// Up to N candidates. `kInstances`: they may be in instances.
template <int N, class A, bool kInstances>
class PendingHits {
 public:
  /// Adds triangle `triangle` = leaf * TriangleBlock::kSize + lane for ray `ray`, in an instance of that
  /// number or kNoInstance. Returns true if there is no room for another.
  OKTETT_INLINE bool add(std::uint32_t ray, std::uint32_t triangle, std::uint32_t instance) {
    ray_[size_] = ray, triangle_[size_] = triangle;
    if constexpr (kInstances) instance_[size_] = instance;
    return ++size_ == N;
  }

  /// Forgets all.
  void clear() { size_ = 0; }

  /// Decides all for `rays` in `accel` and calls store(ray, hit) for each.
  template <class Store>
  OKTETT_NOINLINE void decide(const Accel& accel, const RaySpan& rays, Store&& store) {
    if (size_ == 0) return;
    alignas(64) float column[8][N];
    TriangleLeaf leaf[N];
    std::uint32_t path[N];
    for (int i = 0; i < N; ++i) {
      if (i >= size_) add_again(i);
      Ray ray = rays[ray_[i]];
      if constexpr (kInstances) {
        const TriangleBlock* blocks = accel.blocks.data();
        path[i] = kNoId;
        if (instance_[i] != kNoInstance) ray = go_inside(accel, instance_[i], ray, blocks, path[i]);
        leaf[i] = {blocks, triangle_[i] / TriangleBlock::kSize};
      }
      for (int k = 0; k < 3; ++k) column[k][i] = ray.origin[k], column[3 + k][i] = ray.direction[k];
      column[6][i] = ray.tmin, column[7][i] = ray.tmax;
    }
    const auto vec = [&](int k) {
      return Vec3<F>{F::load(column[k]), F::load(column[k + 1]), F::load(column[k + 2])};
    };
    const RayLanes<F> lanes{vec(0), vec(3), F::load(column[6]), F::load(column[7])};
    HitLanes<F> h;
    unsigned met;
    if constexpr (kInstances)
      met = decide_pairs<N, A>(lanes, gather_triangles<N, A>(leaf, triangle_), h);
    else
      met = decide_pairs<N, A>(lanes, accel.blocks.data(), triangle_, h);
    alignas(64) float t[N], u[N], v[N];
    h.t.store(t), h.u.store(u), h.v.store(v);
    for (int i = 0; i < size_; ++i) {
      if constexpr (!kInstances) leaf[i] = accel.triangles(triangle_[i] / TriangleBlock::kSize);
      const std::uint32_t item = leaf[i].item(triangle_[i] % TriangleBlock::kSize);
      const std::uint32_t instance = kInstances ? path[i] : kNoId;
      store(ray_[i], (met >> i & 1) != 0 ? Hit{t[i], u[i], v[i], item, instance} : Hit{});
    }
    size_ = 0;
  }

 private:
  OKTETT_INLINE void add_again(int i) {
    ray_[i] = ray_[0], triangle_[i] = triangle_[0];
    if constexpr (kInstances) instance_[i] = instance_[0];
  }

  using F = Simd<float, N, A>;

  /// The ray in the space of an instance, with the instance's blocks of triangles and the path of its hits.
  static OKTETT_INLINE Ray go_inside(const Accel& accel, std::uint32_t number, const Ray& ray,
                                     const TriangleBlock*& blocks, std::uint32_t& path) {
    using One = Simd<float, 1, A>;
    const RayLanes<One> outer{broadcast<One>(ray.origin), flush_direction(broadcast<One>(ray.direction)),
                              One(ray.tmin), One(ray.tmax)};
    Ray inside;
    with_instance(accel, number, [&](const auto& instance, const Accel& child) {
      inside = ray_inside<std::decay_t<decltype(instance)>, A>(instance, outer);
      blocks = child.blocks.data(), path = outer_path(instance, kNoId);
    });
    return inside;
  }

  int size_ = 0;
  std::uint32_t triangle_[N], ray_[N], instance_[kInstances ? N : 1];
};

// ---- Rays in flight through nodes and blocks of triangles.

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

  /// The leaf of triangles that the ray is at.
  OKTETT_INLINE TriangleLeaf leaf_of(const InflightRay& ray) const {
    return {blocks(ray), ray.current.triangle_leaf()};
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
    const auto guess = guess_blocks<N, A>(ray, [&](int j) { return leaf_of(ray(j)); });
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
    if (maybe == 0) return;
    const TriangleLeaf leaf = leaf_of(ray);
    const auto repeated = [&] {
      return (kInstances ? *ray.in.accel : accel_).pieces ? repeated_lane<A>(repeated_item(ray), leaf) : 0;
    };
    SureHit hit;
    switch (judge_block<Q, A>(
        guess, maybe, first, leaf, ray.o, ray.d, ray.tmin >= 0, ray.hit_lo, repeated,
        [&]() -> const HitInterval<F>& { return h; }, hit)) {
      case BlockVerdict::missed:
        return;
      case BlockVerdict::hit:
        return found(ray);
      case BlockVerdict::nearest:
        ray.candidate = ray.current.triangle_leaf() * kBlock + static_cast<std::uint32_t>(hit.lane);
        if constexpr (kInstances) ray.in.candidate_instance = ray.in.instance;
        ray.hit_lo = hit.lo;
        return shorten<A>(ray, hit.hi);
      case BlockVerdict::open:
        return decide_leaf(ray);
    }
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
        leaf_triangles_single(tree.triangles(ray.candidate / kBlock),
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
    if (ray.candidate == kDecidedHit && !(hit.t < ray.tmax || comes_first(hit, r.hit(0)))) return;
    ray.candidate = kDecidedHit;
    r.set_hit(0, hit);
    ray.hit_lo = hit.t;
    shorten<A>(ray, hit.t);
  }

  /// Tests the ray's block of triangles exactly.
  OKTETT_NOINLINE void decide_leaf(InflightRay& ray) {
    const NodeRef leaf = ray.current;
    exact_in(ray.in.instance, exact_state(ray), [&](const Accel& tree, RayState<1, A>& state) {
      leaf_triangles_single(tree.triangles(leaf.triangle_leaf()), leaf.triangle_count(), state);
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
