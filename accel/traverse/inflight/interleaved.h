#pragma once
/// \file Many single rays in flight: each step takes one ray through one node or one leaf, prefetches the
/// memory of its next step and goes on with another ray, which hides the latency of cache misses. The rays
/// share nothing, so it does not matter whether they are coherent.
///
/// Triangles are classified in float (kernels/triangle/triangle_classify.h). A triangle that is surely hit,
/// and surely nearer than the nearest hit so far, becomes the ray's candidate hit. Candidates of finished
/// rays are decided together, one in each lane; only a triangle that the classification leaves open is
/// decided at once.

#include <algorithm>

#include "accel/traverse/inflight/bundle_entry.h"
#include "accel/traverse/inflight/decide_pairs.h"
#include "accel/traverse/inflight/inflight_ray.h"
#include "accel/traverse/prefetch.h"
#include "accel/traverse/single.h"

namespace oktett {

/// Rays that are traced at the same time.
inline constexpr int kInflightRays = 48;
/// Leaves are visited when this many rays wait at leaves, or when no ray is at a node.
inline constexpr int kLeafThreshold = 8;
/// A round over the nodes takes at least this many steps. With fewer rays than that, a ray takes several
/// steps. The end of each round costs a mispredicted branch, so rounds must not be short.
inline constexpr int kRoundSteps = 16;

/// Traces a batch of rays; see the top of the file. `kPrefetch`: prefetch the memory of each ray's next step.
template <Query Q, class A, bool kPrefetch>
class InterleavedTraversal {
 public:
  InterleavedTraversal(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out)
      : accel_(accel), rays_(rays), out_(out), extent_(box_extent(accel.bounds)) {}

  void run() {
    Tails tail = tails();
    for (InflightRay& ray : inflight_) refill(ray, tail);
    keep(tail);
    while (nodes_.size() + leaves_.size() + others_.size() > 0) {
      node_round();
      if (leaves_.size() >= kLeafThreshold || nodes_.size() == 0) leaf_round();
      if (others_.size() >= kLeafThreshold || nodes_.size() + leaves_.size() == 0) other_round();
    }
    if constexpr (Q == Query::closest) decide_pending();
  }

 private:
  static constexpr int kBlock = TriangleBlock::kSize;
  static constexpr int kChunk = std::is_same_v<A, Avx512Isa> ? 16 : 8;
  /// Rays whose blocks of triangles are classified together.
  static constexpr int kLeafRays = std::is_same_v<A, Avx512Isa> ? 2 : 1;

  /// Rays that wait for one kind of step, first come, first served.
  struct Queue {
    static constexpr int kPlaces = 256;
    InflightRay **head = ray, **tail = ray;
    InflightRay* ray[kPlaces];

    int size() const { return static_cast<int>(tail - head); }
  };

  /// The ends of the three queues while a round fills them, kept in registers.
  struct Tails {
    InflightRay **node, **leaf, **other;
  };
  /// The ends of the queues, with room for a round and for one more, because enqueue() writes past the end.
  OKTETT_INLINE Tails tails() {
    constexpr int kMost = Queue::kPlaces - std::max(kInflightRays, kRoundSteps) - 1;
    for (Queue* q : {&nodes_, &leaves_, &others_})
      if (OKTETT_UNLIKELY(q->tail > q->ray + kMost))
        q->tail = std::copy(q->head, q->tail, q->ray), q->head = q->ray;
    return {nodes_.tail, leaves_.tail, others_.tail};
  }
  OKTETT_INLINE void keep(const Tails& t) {
    nodes_.tail = t.node, leaves_.tail = t.leaf, others_.tail = t.other;
  }

  /// Queues `ray` for the kind of step that `ref` needs, and prefetches the node or block. Has no branches:
  /// the pointer is written to the ends of all three queues, and one of the ends moves on. For a finished ray
  /// the prefetched address means nothing.
  OKTETT_INLINE void enqueue(InflightRay& ray, NodeRef ref, Tails& t) const {
    const std::uint32_t bits = ref.bits(), is_leaf = bits >> 31;
    if constexpr (kPrefetch) bytes_.prefetch(ref);
    // Arithmetic on the two top bits of NodeRef::bits: compilers turn comparisons into jumps.
    const std::uint32_t is_other = is_leaf & (bits >> 30);
    *t.node = &ray, t.node += 1 - is_leaf;
    *t.leaf = &ray, t.leaf += is_leaf - is_other;
    *t.other = &ray, t.other += is_other;
  }

  OKTETT_INLINE void pop(InflightRay& ray, Tails& t) {
    const NodeRef ref = NodeRef::from_bits(ray.ref[--ray.size]);
    ray.current = ref;
    enqueue(ray, ref, t);
  }

  void node_round() {
    Tails t = tails();
    const BvhNode* nodes = accel_.nodes.data();
    InflightRay** at = nodes_.head;
    for (InflightRay** const end = at + std::max(nodes_.size(), kRoundSteps); at != t.node && at != end; ++at)
      enqueue(**at, step_node<Q, A>(**at, nodes[(*at)->current.bits()]), t);
    nodes_.head = at;
    keep(t);
  }

  void leaf_round() {
    Tails t = tails();
    InflightRay** at = leaves_.head;
    InflightRay** const end = t.leaf;
    for (; end - at >= kLeafRays; at += kLeafRays) leaf_step<kLeafRays>(at, t);
    for (; at != end; ++at) leaf_step<1>(at, t);
    leaves_.head = at;
    keep(t);
  }

  /// N rays, each against its own block of triangles.
  template <int N>
  OKTETT_INLINE void leaf_step(InflightRay* const* rays, Tails& tail) {
    using F = Simd<float, N * kBlock, A>;
    using B = Simd<float, kBlock, A>;
    const TriangleBlock* blocks = accel_.blocks.data();
    // f(ray) of all rays, side by side in lanes.
    const auto each = [&](auto&& f) {
      if constexpr (N == 1)
        return f(*rays[0]);
      else
        return concat(f(*rays[0]), f(*rays[1]));
    };
    const auto number = [&](auto&& f) { return each([&](const InflightRay& r) { return B(f(r)); }); };
    const auto vector = [&](auto&& v) {
      return Vec3<F>{number([&](const InflightRay& r) { return v(r)[0]; }),
                     number([&](const InflightRay& r) { return v(r)[1]; }),
                     number([&](const InflightRay& r) { return v(r)[2]; })};
    };
    const auto corner = [&](int c) {
      const auto axis = [&](int k) {
        return each([&](const InflightRay& r) { return B::load(blocks[r.current.block()].v[c][k]); });
      };
      return Vec3<F>{axis(0), axis(1), axis(2)};
    };
    const auto guess = guess_triangle(vector([](const InflightRay& r) { return r.o; }),
                                      vector([](const InflightRay& r) { return r.d; }),
                                      number([](const InflightRay& r) { return r.weight_scale; }),
                                      number([](const InflightRay& r) { return r.det_scale; }),
                                      filter_triangle(TriangleLanes<F>{corner(0), corner(1), corner(2)}));
    const F tmax = number([](const InflightRay& r) { return r.tmax; });
    unsigned present = 0;
    for (int j = 0; j < N; ++j)
      present |= ((2u << (rays[j]->current.triangle_count() - 1)) - 1) << (j * kBlock);
    const unsigned maybe = bits(maybe_hit(guess, tmax)) & present;
    if (OKTETT_UNLIKELY(maybe != 0)) {
      const HitInterval<F> h = hit_interval(guess, number([](const InflightRay& r) { return r.tmin; }), tmax);
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
    if (maybe != 0 && accel_.pieces)
      maybe &= ~repeated_lane(accel_, ray.candidate, states_[&ray - inflight_],
                              accel_.blocks[ray.current.block()]);
    if (maybe == 0) return;
    const unsigned sure = bits(h.sure) >> first & maybe;
    if (sure != 0) {
      if constexpr (Q == Query::any) return found(ray);
      const SureHit hit = nearest_sure(h, sure, first);
      if ((maybe & (maybe - 1)) != 0) maybe &= bits(maybe_hit(guess, F(hit.hi))) >> first;
      if (maybe == 1u << hit.lane && hit.hi < ray.hit_lo) {
        ray.candidate = ray.current.block() * kBlock + static_cast<std::uint32_t>(hit.lane);
        ray.hit_lo = hit.lo;
        return shorten<A>(ray, hit.hi);
      }
    }
    decide_leaf(ray);
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
      r.set(rays_[ray.index], accel_.bounds);
      ray.has_state = 1;
    }
    if (ray.candidate < kDecidedHit)
      leaf_triangles_single(accel_.blocks[ray.candidate / kBlock],
                            static_cast<int>(ray.candidate % kBlock) + 1, r);
    return r;
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

  /// Tests the ray's block of triangles exactly.
  OKTETT_NOINLINE void decide_leaf(InflightRay& ray) {
    RayState<1, A>& r = exact_state(ray);
    const NodeRef leaf = ray.current;
    leaf_triangles_single(accel_.blocks[leaf.block()], leaf.triangle_count(), r);
    adopt(ray);
  }

  /// Rays that are finished or at a leaf of the table.
  OKTETT_NOINLINE void other_round() {
    Tails tail = tails();
    for (int rest = others_.size(); rest > 0; --rest) {
      InflightRay& ray = **others_.head++;
      const NodeRef ref = ray.current;
      if (ref.is_none()) {
        finish(ray);
        refill(ray, tail);
      } else {
        table_leaf_single<Q>(accel_, accel_.leaves[ref.table_index()], exact_state(ray));
        adopt(ray);
        pop(ray, tail);
      }
    }
    keep(tail);
  }

  void finish(const InflightRay& ray) {
    if constexpr (Q == Query::any) {
      out_.occluded[ray.index] = ray.candidate != kNoCandidate;
    } else if (ray.candidate < kDecidedHit) {
      pending_ray_[pending_] = ray.index, pending_triangle_[pending_] = ray.candidate;
      if (++pending_ == kChunk) decide_pending();
    } else {
      out_.set(ray.index, ray.candidate == kDecidedHit ? states_[&ray - inflight_].hit(0) : Hit{});
    }
  }

  /// Starts the next ray of the batch in the place of a finished one.
  void refill(InflightRay& ray, Tails& tail) {
    for (; next_ < rays_.size; ++next_) {
      const int i = static_cast<int>(next_ % kChunk);
      if constexpr (Q == Query::any)
        if (next_ % kBundleRays == 0) set_entry();
      if (i == 0) chunk_.set(rays_, next_, extent_);
      if ((chunk_.tame >> i & 1) != 0) {
        start(ray, i, tail);
        ++next_;
        return;
      }
      // The ray is not valid, or its numbers are too large or too small for the fast arithmetic.
      out_.set(next_, trace_exact<Q, A>(accel_, rays_[next_]));
    }
  }

  /// Prepares the entry of the next bundle.
  OKTETT_NOINLINE void set_entry() {
    has_entry_ = false;
    const std::size_t count = std::min<std::size_t>(kBundleRays, rays_.size - next_);
    if (count < kBundleRays / 4 || accel_.root.is_leaf()) return;
    const Box reach = reach_of<A>(rays_.part(next_, count), extent_);
    if (reach.empty()) return;
    entry_.set(accel_, reach);
    has_entry_ = true;
  }

  OKTETT_INLINE void start(InflightRay& ray, int i, Tails& tail) {
    start_ray(ray, chunk_, i, accel_.root);
    if constexpr (Q == Query::any) {
      if (has_entry_) {
        ray.size = 1;
        step_node<Q, A>(ray, entry_.node());
        ++ray.size;  // what the step has popped is popped below
      }
    }
    ray.index = static_cast<std::uint32_t>(next_);
    if (OKTETT_UNLIKELY(!accel_.unbounded.empty())) {
      RayState<1, A>& r = exact_state(ray);
      for (const LeafEntry& leaf : accel_.unbounded) table_leaf_single<Q>(accel_, leaf, r);
      adopt(ray);
    }
    pop(ray, tail);
  }

  /// Decides the candidates of finished rays, one in each lane, and stores the hits.
  OKTETT_NOINLINE void decide_pending() {
    if (pending_ == 0) return;
    using C = Simd<float, kChunk, A>;
    alignas(64) float column[8][kChunk];
    for (int i = 0; i < kChunk; ++i) {
      if (i >= pending_) pending_ray_[i] = pending_ray_[0], pending_triangle_[i] = pending_triangle_[0];
      const std::size_t ray = pending_ray_[i];
      for (int k = 0; k < 3; ++k)
        column[k][i] = rays_.origin[k][ray], column[3 + k][i] = rays_.direction[k][ray];
      column[6][i] = rays_.tmin[ray], column[7][i] = rays_.tmax[ray];
    }
    const auto vec = [&](int k) {
      return Vec3<C>{C::load(column[k]), C::load(column[k + 1]), C::load(column[k + 2])};
    };
    const RayLanes<C> rays{vec(0), vec(3), C::load(column[6]), C::load(column[7])};
    HitLanes<C> h;
    const unsigned met = decide_pairs<kChunk, A>(rays, accel_.blocks.data(), pending_triangle_, h);
    alignas(64) float t[kChunk], u[kChunk], v[kChunk];
    h.t.store(t), h.u.store(u), h.v.store(v);
    for (int i = 0; i < pending_; ++i) {
      const std::uint32_t item =
          accel_.blocks[pending_triangle_[i] / kBlock].item[pending_triangle_[i] % kBlock];
      out_.set(pending_ray_[i], (met >> i & 1) != 0 ? Hit{t[i], u[i], v[i], item, kNoId} : Hit{});
    }
    pending_ = 0;
  }

  const Accel& accel_;
  const RaySpan rays_;
  const HitSink<Q> out_;
  const float extent_;
  const TreeBytes bytes_{accel_};
  std::size_t next_ = 0;
  Queue nodes_, leaves_, others_;
  int pending_ = 0;
  std::uint32_t pending_triangle_[kChunk], pending_ray_[kChunk];
  RayChunk<kChunk, A> chunk_;
  bool has_entry_ = false;
  BundleEntry<A> entry_;
  InflightRay inflight_[kInflightRays];
  RayState<1, A> states_[kInflightRays];
};

template <Query Q, class A, bool kPrefetch>
OKTETT_NOINLINE void run_interleaved(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out) {
  InterleavedTraversal<Q, A, kPrefetch>(accel, rays, out).run();
}

/// All rays of a span against everything; results in the order of the rays.
template <Query Q, class A>
void trace_interleaved(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out) {
  if (tree_bytes(accel) > kPrefetchBytes)
    run_interleaved<Q, A, true>(accel, rays, out);
  else
    run_interleaved<Q, A, false>(accel, rays, out);
}

}  // namespace oktett
