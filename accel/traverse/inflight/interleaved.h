#pragma once
/// \file Many single rays in flight: each step takes one ray through one node or one leaf, asks for the
/// memory of its next step and goes on with another ray, so that a miss in the caches costs no time. Nothing
/// is shared between the rays, so their directions do not matter.
///
/// Triangles are classified in float (kernels/triangle/triangle_classify.h). A triangle that is surely hit
/// and surely nearer than what is held becomes the ray's candidate, to be decided with those of other rays at
/// the end; only what is unclear is decided at once.

#include "accel/traverse/inflight/decide_pairs.h"
#include "accel/traverse/inflight/inflight_ray.h"
#include "accel/traverse/single.h"

namespace oktett {

/// Rays in flight, and how many must wait for a leaf before leaves are visited while nodes can be.
inline constexpr int kInflightRays = 32;
inline constexpr int kLeafThreshold = 8;

/// Trees above this size are prefetched; in smaller ones the caches answer faster than asking takes.
inline constexpr std::size_t kPrefetchBytes = std::size_t{32} << 20;

inline std::size_t tree_bytes(const Accel& accel) { return accel.stats.node_bytes + accel.stats.leaf_bytes; }

/// `kPrefetch`: asks for the memory of a step when it is chosen.
template <Query Q, class A, bool kPrefetch>
class InterleavedTraversal {
 public:
  InterleavedTraversal(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out)
      : accel_(accel), rays_(rays), out_(out), extent_(box_extent(accel.bounds)) {}

  void run() {
    Tails tail = tails();
    for (InflightRay& slot : inflight_) refill(slot, tail);
    keep(tail);
    while (nodes_.size + leaves_.size + others_.size > 0) {
      node_round();
      if (leaves_.size >= kLeafThreshold || nodes_.size == 0) leaf_round();
      if (others_.size >= kLeafThreshold || nodes_.size + leaves_.size == 0) other_round();
    }
    if constexpr (Q == Query::closest) decide_candidates();
  }

 private:
  static constexpr int kBlock = TriangleBlock::kSize;
  static constexpr int kChunk = std::is_same_v<A, Avx512Isa> ? 16 : 8;
  /// Rays whose leaves are visited at once.
  static constexpr int kLeafRays = std::is_same_v<A, Avx512Isa> ? 2 : 1;

  /// Slots that wait for one kind of step.
  struct Queue {
    int size = 0;
    InflightRay* slot[kInflightRays + 1];  ///< one more: entries that are not kept are written too
  };

  /// The ends of the three queues while a round fills them, to be kept in registers.
  struct Tails {
    InflightRay **node, **leaf, **other;
  };
  OKTETT_INLINE Tails tails() {
    return {nodes_.slot + nodes_.size, leaves_.slot + leaves_.size, others_.slot + others_.size};
  }
  OKTETT_INLINE void keep(const Tails& t) {
    nodes_.size = static_cast<int>(t.node - nodes_.slot),
    leaves_.size = static_cast<int>(t.leaf - leaves_.slot);
    others_.size = static_cast<int>(t.other - others_.slot);
  }

  /// `slot` goes on to `ref`: asks for its memory, whose address does not matter for an end, and queues it
  /// for its kind of step, all without a branch.
  OKTETT_INLINE void enqueue(InflightRay& slot, NodeRef ref, Tails& t) const {
    const std::uint32_t bits = ref.bits(), is_leaf = bits >> 31;
    if constexpr (kPrefetch) {
      const std::size_t index = bits & (NodeRef::kMaxBlocks - 1);
      const char* at = base_[is_leaf] + index * sizeof(BvhNode) +
                       (index & (0 - std::size_t{is_leaf})) * (sizeof(TriangleBlock) - sizeof(BvhNode));
      for (std::size_t line = 0; line < sizeof(TriangleBlock); line += 64)
        __builtin_prefetch(at + (line < sizeof(BvhNode) ? line : is_leaf * line));
    }
    // Arithmetic on the two top bits of NodeRef::bits, as compilers turn comparisons into jumps.
    const std::uint32_t is_other = is_leaf & (bits >> 30);
    *t.node = &slot, t.node += 1 - is_leaf;
    *t.leaf = &slot, t.leaf += is_leaf - is_other;
    *t.other = &slot, t.other += is_other;
  }

  OKTETT_INLINE void pop(InflightRay& slot, Tails& t) {
    const NodeRef ref = NodeRef::from_bits(slot.ref[--slot.size]);
    slot.current = ref;
    enqueue(slot, ref, t);
  }

  void node_round() {
    const Queue now = nodes_;
    nodes_.size = 0;
    Tails t = tails();
    const BvhNode* nodes = accel_.nodes.data();
    for (int i = 0; i < now.size; ++i) {
      InflightRay& slot = *now.slot[i];
      enqueue(slot, step_node<Q, A>(slot, nodes[slot.current.bits()]), t);
    }
    keep(t);
  }

  void leaf_round() {
    const Queue now = leaves_;
    leaves_.size = 0;
    Tails tail = tails();
    int i = 0;
    for (; i + kLeafRays <= now.size; i += kLeafRays) leaf_step<kLeafRays>(now.slot + i, tail);
    for (; i < now.size; ++i) leaf_step<1>(now.slot + i, tail);
    keep(tail);
  }

  /// N rays, each against its own block.
  template <int N>
  OKTETT_INLINE void leaf_step(InflightRay* const* slots, Tails& tail) {
    using F = Simd<float, N * kBlock, A>;
    using B = Simd<float, kBlock, A>;
    const TriangleBlock* blocks = accel_.blocks.data();
    // f(slot) for all rays side by side.
    const auto each = [&](auto&& f) {
      if constexpr (N == 1)
        return f(*slots[0]);
      else
        return concat(f(*slots[0]), f(*slots[1]));
    };
    const auto ray = [&](auto&& f) { return each([&](const InflightRay& s) { return B(f(s)); }); };
    const auto corner = [&](int c) {
      const auto axis = [&](int k) {
        return each([&](const InflightRay& s) { return B::load(blocks[s.current.block()].v[c][k]); });
      };
      return Vec3<F>{axis(0), axis(1), axis(2)};
    };
    const auto vec = [&](auto&& v) {
      return Vec3<F>{ray([&](const InflightRay& s) { return v(s)[0]; }),
                     ray([&](const InflightRay& s) { return v(s)[1]; }),
                     ray([&](const InflightRay& s) { return v(s)[2]; })};
    };
    const auto guess = guess_triangle(vec([](const InflightRay& s) { return s.o; }),
                                      vec([](const InflightRay& s) { return s.d; }),
                                      ray([](const InflightRay& s) { return s.weight_scale; }),
                                      ray([](const InflightRay& s) { return s.det_scale; }),
                                      filter_triangle(TriangleLanes<F>{corner(0), corner(1), corner(2)}));
    const F tmax = ray([](const InflightRay& s) { return s.tmax; });
    unsigned present = 0;
    for (int j = 0; j < N; ++j)
      present |= ((2u << (slots[j]->current.triangle_count() - 1)) - 1) << (j * kBlock);
    const unsigned maybe = bits(maybe_hit(guess, tmax)) & present;
    if (OKTETT_UNLIKELY(maybe != 0)) {
      const HitInterval<F> h = hit_interval(guess, ray([](const InflightRay& s) { return s.tmin; }), tmax);
      for (int j = 0; j < N; ++j) take(*slots[j], guess, h, maybe, j * kBlock);
    }
    for (int j = 0; j < N; ++j) pop(*slots[j], tail);
  }

  /// What is not surely missed of the leaf that `slot` is at, the block in lanes `first`, ... of the guess.
  template <class F>
  OKTETT_INLINE void take(InflightRay& slot, const TriangleGuess<F>& guess, const HitInterval<F>& h,
                          unsigned maybe, int first) {
    maybe = maybe >> first & ((1u << kBlock) - 1);
    if (maybe != 0 && accel_.pieces) maybe &= ~held_again(slot);
    if (maybe == 0) return;
    const unsigned sure = bits(h.sure) >> first & maybe;
    if (sure != 0) {
      if constexpr (Q == Query::any) return found(slot);
      alignas(64) float lo[F::kWidth], hi[F::kWidth];
      h.lo.store(lo), h.hi.store(hi);
      int nearest = __builtin_ctz(sure);
      for (unsigned rest = sure & (sure - 1); rest != 0; rest &= rest - 1)
        if (hi[first + __builtin_ctz(rest)] < hi[first + nearest]) nearest = __builtin_ctz(rest);
      const float least = lo[first + nearest], most = hi[first + nearest];
      if ((maybe & (maybe - 1)) != 0) maybe &= bits(maybe_hit(guess, F(most))) >> first;
      if (maybe == 1u << nearest && most < slot.held_lo) {
        slot.held = slot.current.block() * kBlock + static_cast<std::uint32_t>(nearest);
        slot.held_lo = least;
        return shorten(slot, most);
      }
    }
    decide_leaf(slot);
  }

  /// The lane of the leaf that `slot` is at which holds the triangle that the ray holds already: a triangle
  /// in pieces stands in several leaves, and deciding it twice would tell nothing new.
  OKTETT_INLINE unsigned held_again(const InflightRay& slot) const {
    std::uint32_t item = kNoId;
    if (slot.held < kHoldsExact) {
      item = accel_.blocks[slot.held / kBlock].item[slot.held % kBlock];
    } else if (slot.held == kHoldsExact) {
      const RayState<1, A>& r = states_[&slot - inflight_];
      if (r.path[0] == kNoId) item = r.item[0];
    }
    using I = Simd<std::int32_t, kBlock, A>;
    const auto* items = reinterpret_cast<const std::int32_t*>(accel_.blocks[slot.current.block()].item);
    return item == kNoId ? 0 : bits(I::load(items) == I(static_cast<std::int32_t>(item)));
  }

  /// For Query::any: nothing is left to do.
  OKTETT_INLINE void found(InflightRay& slot) {
    slot.held = kHoldsExact;
    slot.size = 1;
  }

  /// The state of `slot` for exact tests, with a candidate decided.
  OKTETT_NOINLINE RayState<1, A>& exact_state(InflightRay& slot) {
    using One = Simd<float, 1, A>;
    RayState<1, A>& r = states_[&slot - inflight_];
    if (slot.exact == 0) {
      const Ray ray = rays_[slot.ray];
      r.set(broadcast<One>(ray.origin), broadcast<One>(ray.direction), One(ray.tmin), One(ray.tmax),
            accel_.bounds);
      slot.exact = 1;
    }
    if (slot.held < kHoldsExact)
      leaf_triangles_single(accel_.blocks[slot.held / kBlock], static_cast<int>(slot.held % kBlock) + 1, r);
    return r;
  }

  /// Takes over what exact tests have found.
  OKTETT_INLINE void adopt(InflightRay& slot) {
    const RayState<1, A>& r = states_[&slot - inflight_];
    if (r.item[0] == kNoId) return;
    if constexpr (Q == Query::any) return found(slot);
    slot.held = kHoldsExact;
    slot.held_lo = r.tmax[0];
    shorten(slot, r.tmax[0]);
  }

  OKTETT_NOINLINE void decide_leaf(InflightRay& slot) {
    RayState<1, A>& r = exact_state(slot);
    const NodeRef leaf = slot.current;
    leaf_triangles_single(accel_.blocks[leaf.block()], leaf.triangle_count(), r);
    adopt(slot);
  }

  /// Finished rays, and leaves of the table.
  OKTETT_NOINLINE void other_round() {
    const Queue now = others_;
    others_.size = 0;
    Tails tail = tails();
    for (int i = 0; i < now.size; ++i) {
      InflightRay& slot = *now.slot[i];
      const NodeRef ref = slot.current;
      if (ref.is_none()) {
        finish(slot);
        refill(slot, tail);
      } else {
        table_leaf_single<Q>(accel_, accel_.leaves[ref.table_index()], exact_state(slot));
        adopt(slot);
        pop(slot, tail);
      }
    }
    keep(tail);
  }

  void finish(const InflightRay& slot) {
    if constexpr (Q == Query::any) {
      out_.occluded[slot.ray] = slot.held != kHoldsNothing;
    } else if (slot.held < kHoldsExact) {
      candidate_ray_[candidates_] = slot.ray, candidate_[candidates_] = slot.held;
      if (++candidates_ == kChunk) decide_candidates();
    } else {
      out_.set(slot.ray, slot.held == kHoldsExact ? states_[&slot - inflight_].hit(0) : Hit{});
    }
  }

  /// Puts the next ray that needs the tree into `slot`.
  void refill(InflightRay& slot, Tails& tail) {
    for (; next_ < rays_.size; ++next_) {
      const int i = static_cast<int>(next_ % kChunk);
      if (i == 0) chunk_.set(rays_, next_, extent_);
      if ((chunk_.tame >> i & 1) != 0) {
        start(slot, i, tail);
        ++next_;
        return;
      }
      trace_alone(next_, (chunk_.valid >> i & 1) != 0);
    }
  }

  OKTETT_INLINE void start(InflightRay& slot, int i, Tails& tail) {
    fill_slot(slot, chunk_, i, accel_.root);
    slot.ray = static_cast<std::uint32_t>(next_);
    if (OKTETT_UNLIKELY(!accel_.unbounded.empty())) {
      RayState<1, A>& r = exact_state(slot);
      for (const LeafEntry& leaf : accel_.unbounded) table_leaf_single<Q>(accel_, leaf, r);
      adopt(slot);
    }
    pop(slot, tail);
  }

  /// A ray whose numbers the fast arithmetic is not made for.
  OKTETT_NOINLINE void trace_alone(std::size_t ray, bool valid) {
    using One = Simd<float, 1, A>;
    RayState<1, A> r;
    const Ray source = rays_[ray];
    r.set(broadcast<One>(source.origin), broadcast<One>(source.direction), One(source.tmin), One(source.tmax),
          accel_.bounds);
    if (valid) trace_single<Q>(accel_, r);
    out_.set(ray, r.hit(0));
  }

  /// Decides what has gathered, all lanes at once. Only what surely is hit has been put off.
  OKTETT_NOINLINE void decide_candidates() {
    if (candidates_ == 0) return;
    using C = Simd<float, kChunk, A>;
    alignas(64) float column[8][kChunk];
    for (int i = 0; i < kChunk; ++i) {
      if (i >= candidates_) candidate_ray_[i] = candidate_ray_[0], candidate_[i] = candidate_[0];
      const std::size_t ray = candidate_ray_[i];
      for (int k = 0; k < 3; ++k)
        column[k][i] = rays_.origin[k][ray], column[3 + k][i] = rays_.direction[k][ray];
      column[6][i] = rays_.tmin[ray], column[7][i] = rays_.tmax[ray];
    }
    const auto vec = [&](int k) {
      return Vec3<C>{C::load(column[k]), C::load(column[k + 1]), C::load(column[k + 2])};
    };
    const RayLanes<C> rays{vec(0), vec(3), C::load(column[6]), C::load(column[7])};
    HitLanes<C> h;
    const unsigned met = decide_pairs<kChunk, A>(rays, accel_.blocks.data(), candidate_, h);
    alignas(64) float t[kChunk], u[kChunk], v[kChunk];
    h.t.store(t), h.u.store(u), h.v.store(v);
    for (int i = 0; i < candidates_; ++i) {
      const std::uint32_t item = accel_.blocks[candidate_[i] / kBlock].item[candidate_[i] % kBlock];
      out_.set(candidate_ray_[i], (met >> i & 1) != 0 ? Hit{t[i], u[i], v[i], item, kNoId} : Hit{});
    }
    candidates_ = 0;
  }

  const Accel& accel_;
  const RaySpan rays_;
  const HitSink<Q> out_;
  const float extent_;
  const char* const base_[2] = {reinterpret_cast<const char*>(accel_.nodes.data()),
                                reinterpret_cast<const char*>(accel_.blocks.data())};
  std::size_t next_ = 0;
  Queue nodes_, leaves_, others_;
  int candidates_ = 0;
  std::uint32_t candidate_[kChunk], candidate_ray_[kChunk];
  RayChunk<kChunk, A> chunk_;
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
