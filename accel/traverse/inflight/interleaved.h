#pragma once
/// \file A batch of single rays, interleaved: when a ray in flight is finished, the next one of the batch
/// takes its place. Candidates of finished rays are decided together, one in each lane.

#include "accel/traverse/inflight/inflight_ray.h"
#include "accel/traverse/inflight/inflight_traversal.h"

namespace oktett {

// ---- Where short rays that start close together enter the tree: at the nodes and leaves that a box around
// all of them meets. They replace the top of the tree, whose levels cost each ray steps and hardly ever
// separate the rays.

/// Rays that share an entry: neighbours in their batch.
inline constexpr int kBundleRays = 256;
/// Relative error of the ends of rays and of the points at which they are hit, and a reserve.
inline constexpr float kBundleSlack = 0x1p-20f;

/// A box around the points at which rays may be hit, from their origins to their ends, with room for
/// rounding. Empty if a number of a ray is not finite. `extent` is the greatest |coordinate| of the scene.
template <class A>
OKTETT_INLINE Box reach_of(const RaySpan& rays, float extent) {
  using F = Simd<float, 8, A>;
  const F infinity(std::numeric_limits<float>::infinity()), big(std::numeric_limits<float>::max());
  Vec3<F> lo{infinity, infinity, infinity}, hi{-infinity, -infinity, -infinity};
  auto finite = F::M::all_true();
  for (std::size_t b = 0; b < rays.size; b += 8) {
    const RayLanes<F> r = load_span<F>(rays, b);
    const auto add = [&](const F& from, const F& direction, F& low, F& high) {
      const F to = fast_fma(direction, r.tmax, from);
      finite = finite & (abs(from) <= big) & (abs(to) <= big);
      low = min(low, min(from, to)), high = max(high, max(from, to));
    };
    add(r.o.x, r.d.x, lo.x, hi.x), add(r.o.y, r.d.y, lo.y, hi.y), add(r.o.z, r.d.z, lo.z, hi.z);
  }
  if (bits(finite) != bits(F::M::all_true())) return {};
  alignas(64) float low[3][8], high[3][8];
  lo.x.store(low[0]), lo.y.store(low[1]), lo.z.store(low[2]);
  hi.x.store(high[0]), hi.y.store(high[1]), hi.z.store(high[2]);
  Box box;
  for (int i = 0; i < 8; ++i) {
    box.lo = min(box.lo, Vec3f{low[0][i], low[1][i], low[2][i]});
    box.hi = max(box.hi, Vec3f{high[0][i], high[1][i], high[2][i]});
  }
  const float slack =
      kBundleSlack * (extent + std::max(max_component(abs(box.lo)), max_component(abs(box.hi))));
  const Vec3f room{slack, slack, slack};
  return {box.lo - room, box.hi + room};
}

/// A node made for one bundle: its children are all that the rays of the bundle can meet in the tree.
template <class A>
class BundleEntry {
 public:
  /// Collects what `reach` meets, from the root downwards, as long as there is room; `accel.root` is a node.
  void set(const Accel& accel, const Box& reach) {
    size_ = 0;
    append(accel.nodes[accel.root.node_index()], reach);
    while (size_ > 0) {
      int widest = 0;
      for (int i = 1; i < size_; ++i)
        if (area_[i] > area_[widest]) widest = i;
      if (!(area_[widest] > 0)) break;
      const BvhNode& node = accel.nodes[child_[widest].node_index()];
      if (size_ - 1 + __builtin_popcount(met(node, reach)) > BvhNode::kWidth) {
        area_[widest] = 0;
        continue;
      }
      --size_;
      for (auto& row : plane_) row[widest] = row[size_];
      child_[widest] = child_[size_], area_[widest] = area_[size_];
      append(node, reach);
    }
    constexpr float kInf = std::numeric_limits<float>::infinity();
    for (int i = 0; i < BvhNode::kWidth; ++i) {
      for (int k = 0; k < 6; ++k) node_.plane[k][i] = i < size_ ? plane_[k][i] : k % 2 == 0 ? kInf : -kInf;
      node_.child[i] = i < size_ ? child_[i] : NodeRef::none();
    }
  }

  const BvhNode& node() const { return node_; }

 private:
  using F = Simd<float, BvhNode::kWidth, A>;

  /// The children of `node` that `reach` meets, as bits.
  static OKTETT_INLINE unsigned met(const BvhNode& node, const Box& reach) {
    const auto axis = [&](int k, float lo, float hi) {
      return (F::load(node.plane[2 * k]) <= F(hi)) & (F(lo) <= F::load(node.plane[2 * k + 1]));
    };
    return bits(axis(0, reach.lo.x, reach.hi.x) & axis(1, reach.lo.y, reach.hi.y) &
                axis(2, reach.lo.z, reach.hi.z));
  }

  /// Adds the children of `node` that `reach` meets, and half the surfaces of their boxes inside `reach` (0
  /// for leaves).
  OKTETT_INLINE void append(const BvhNode& node, const Box& reach) {
    int count = 0;
    for (unsigned rest = met(node, reach); rest != 0; rest &= rest - 1, ++count) {
      const int from = __builtin_ctz(rest), to = size_ + count;
      for (int k = 0; k < 6; ++k) plane_[k][to] = node.plane[k][from];
      child_[to] = node.child[from];
    }
    const auto side = [&](int k, float lo, float hi) {
      return min(F::load(plane_[2 * k + 1] + size_), F(hi)) - max(F::load(plane_[2 * k] + size_), F(lo));
    };
    const F x = side(0, reach.lo.x, reach.hi.x), y = side(1, reach.lo.y, reach.hi.y),
            z = side(2, reach.lo.z, reach.hi.z);
    (x * y + y * z + z * x).store(area_ + size_);
    for (int i = size_; i < size_ + count; ++i)
      if (child_[i].is_leaf()) area_[i] = 0;
    size_ += count;
  }

  int size_ = 0;
  /// Columns; append() writes eight elements at a time, those behind size_ have no meaning.
  float plane_[6][2 * BvhNode::kWidth], area_[2 * BvhNode::kWidth];
  NodeRef child_[2 * BvhNode::kWidth];
  BvhNode node_;
};

// ---- A batch of single rays, interleaved.

/// Traces rays of a batch; see the top of the file.
template <Query Q, class A, InflightTrees kTrees>
class InterleavedTraversal : InflightTraversal<InterleavedTraversal<Q, A, kTrees>, Q, A, kTrees> {
  using Base = InflightTraversal<InterleavedTraversal, Q, A, kTrees>;

 public:
  InterleavedTraversal(const Accel& accel, const RaySpan& rays, const BatchChunks& chunks,
                       const HitSink<Q>& out)
      : Base(accel), chunks_(chunks), out_(out), extent_(box_extent(accel.bounds)) {
    rays_ = rays;
  }

  void run() {
    Tails tail = queues_.tails();
    for (InflightRay& ray : inflight_) refill(ray, tail);
    queues_.keep(tail);
    while (!queues_.empty()) this->advance();
    if constexpr (Q == Query::closest) decide();
  }

 private:
  friend Base;
  using Base::accel_, Base::rays_, Base::queues_, Base::pending_, Base::chunk_, Base::inflight_,
      Base::states_, Base::spheres_;
  using typename Base::Tails;

  OKTETT_INLINE void finish(InflightRay& ray, Tails& tail) {
    if constexpr (Q == Query::any) {
      out_.occluded[ray.index] = ray.candidate != kNoCandidate;
    } else if (ray.candidate < kDecidedHit) {
      if (pending_.add(ray.index, ray.candidate, ray.in.candidate_instance)) decide();
    } else {
      out_.set(ray.index, ray.candidate == kDecidedHit ? states_[&ray - inflight_].hit(0) : Hit{});
    }
    refill(ray, tail);
  }

  void decide() {
    pending_.decide(accel_, rays_, [&](std::uint32_t ray, const Hit& h) { out_.set(ray, h); });
  }

  /// Starts the next ray in the place of a finished one.
  void refill(InflightRay& ray, Tails& tail) {
    for (;;) {
      if (lane_ == lanes_ && !next_chunk()) return;
      const int i = lane_++;
      if ((chunk_.tame >> i & 1) != 0) return start(ray, i, tail);
      // The ray is not valid, or its numbers are too large or too small for the fast arithmetic.
      const std::size_t position = begin_ + static_cast<std::size_t>(i);
      out_.set(position, trace_exact<Q, A>(accel_, rays_[position]));
    }
  }

  /// Where chunk `k` begins in the batch.
  OKTETT_INLINE std::size_t begin_of(std::size_t k) const {
    return chunks_.first == nullptr ? k * Base::kChunk : chunks_.first[k];
  }

  /// Prepares the next chunk; false if there is none.
  OKTETT_INLINE bool next_chunk() {
    if (next_ == chunks_.count) return false;
    if constexpr (Q == Query::any)
      if (next_ % kBundleChunks == 0) set_entry();
    begin_ = begin_of(next_++);
    lane_ = 0, lanes_ = static_cast<int>(std::min<std::size_t>(Base::kChunk, rays_.size - begin_));
    chunk_.set(rays_, begin_, extent_);
    spheres_.prepare(chunk_);
    if (OKTETT_UNLIKELY(only_planes_)) meet_planes();
    return true;
  }

  /// Tests the rays of the chunk against planes, all at once. A ray ends at its nearest plane.
  OKTETT_NOINLINE void meet_planes() {
    using F = Simd<float, Base::kChunk, A>;
    const auto vec = [](const float(&v)[3][Base::kChunk]) {
      return Vec3<F>{F::load(v[0]), F::load(v[1]), F::load(v[2])};
    };
    planes_.set_rays(vec(chunk_.o), vec(chunk_.d), F::load(chunk_.tmin), F::load(chunk_.tmax));
    for (const LeafEntry& leaf : accel_.unbounded)
      leaf_shape_packet<Plane>(std::get<Plane::Pool>(accel_.pools), leaf.begin, leaf.count, planes_,
                               chunk_.tame);
    std::copy(planes_.tmax, planes_.tmax + Base::kChunk, chunk_.tmax);
  }

  /// Prepares the entry of the next bundle.
  OKTETT_NOINLINE void set_entry() {
    has_entry_ = false;
    const std::size_t count = std::min(kBundleChunks, chunks_.count - next_);
    if (count < kBundleChunks / 4 || accel_.root.is_leaf()) return;
    // The box also covers the rays between these chunks, which are not traced here.
    const std::size_t begin = begin_of(next_), last = begin_of(next_ + count - 1);
    const std::size_t end = std::min(last + Base::kChunk, rays_.size);
    const Box reach = reach_of<A>(rays_.part(begin, end - begin), extent_);
    if (reach.empty()) return;
    entry_.set(accel_, reach);
    has_entry_ = true;
  }

  OKTETT_INLINE void start(InflightRay& ray, int i, Tails& tail) {
    start_ray(ray, chunk_, i, accel_.root, triangles_);
    spheres_.start(&ray - inflight_, chunk_, i);
    if constexpr (Base::kInstances) ray.in.set(accel_);
    if constexpr (Q == Query::any) {
      if (has_entry_) {
        ray.size = 1;
        step_node<Q, A>(ray, entry_.node());
        ++ray.size;  // what the step has popped is popped below
      }
    }
    ray.index = static_cast<std::uint32_t>(begin_ + static_cast<std::size_t>(i));
    if (OKTETT_UNLIKELY(only_planes_)) {
      ray.candidate = planes_.item[i] == kNoId ? kNoCandidate : kDecidedHit;
      if constexpr (Q == Query::closest)
        states_[&ray - inflight_].take(0, planes_, i);
      else if (ray.candidate == kDecidedHit)
        this->found(ray);
    } else if (OKTETT_UNLIKELY(!accel_.unbounded.empty())) {
      RayState<1, A>& r = this->exact_state(ray);
      for (const LeafEntry& leaf : accel_.unbounded) table_leaf_single<Q>(accel_, leaf, r);
      this->adopt(ray);
    }
    this->pop(ray, tail);
  }

  static constexpr std::size_t kBundleChunks = kBundleRays / Base::kChunk;

  const BatchChunks chunks_;
  const HitSink<Q> out_;
  const float extent_;
  std::size_t next_ = 0, begin_ = 0;  ///< number of the next chunk, and where the present one begins
  int lane_ = 0, lanes_ = 0;          ///< the next ray of the present chunk, and how many rays that has
  bool has_entry_ = false;
  /// Rays may meet triangles or go into instances.
  const bool triangles_ = Base::kInstances || accel_.blocks.data() != nullptr;
  /// All unbounded shapes are planes, and there are some.
  const bool only_planes_ =
      !accel_.unbounded.empty() &&
      std::ranges::all_of(accel_.unbounded, [](const LeafEntry& leaf) { return leaf.kind == Kind::plane; });
  RayState<Base::kChunk, A> planes_;  ///< the chunk and its hits on them
  BundleEntry<A> entry_;
};

template <Query Q, class A, InflightTrees kTrees>
OKTETT_NOINLINE void run_interleaved(const Accel& accel, const RaySpan& rays, const BatchChunks& chunks,
                                     const HitSink<Q>& out) {
  InterleavedTraversal<Q, A, kTrees>(accel, rays, chunks, out).run();
}

template <Query Q, class A>
void trace_interleaved(const Accel& accel, const RaySpan& rays, const BatchChunks& chunks,
                       const HitSink<Q>& out) {
  if constexpr (!std::is_same_v<A, ScalarIsa>) {
    if (has_instances(accel))
      run_interleaved<Q, A, InflightTrees::instances>(accel, rays, chunks, out);
    else if (pays_to_prefetch(accel, rays))
      run_interleaved<Q, A, InflightTrees::large>(accel, rays, chunks, out);
    else
      run_interleaved<Q, A, InflightTrees::small>(accel, rays, chunks, out);
  }
}

}  // namespace oktett
