#pragma once
/// \file A batch of single rays, interleaved: when a ray in flight is finished, the next one of the batch
/// takes its place. Candidates of finished rays are decided together, one in each lane.

#include "accel/traverse/inflight/bundle_entry.h"
#include "accel/traverse/inflight/inflight_traversal.h"

namespace oktett {

/// Which rays of a batch are traced: all, or only some chunks of kChunkRays<A> neighbours. The last chunk of
/// a batch may be shorter.
struct BatchChunks {
  const std::uint32_t* first;  ///< of each chunk, the position of its first ray; null: all rays
  std::size_t count;           ///< of chunks

  template <class A>
  static BatchChunks all(const RaySpan& rays) {
    return {nullptr, (rays.size + kChunkRays<A> - 1) / kChunkRays<A>};
  }
};

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

/// The rays in `chunks` against everything; each hit is at the position of its ray.
template <Query Q, class A>
void trace_interleaved(const Accel& accel, const RaySpan& rays, const BatchChunks& chunks,
                       const HitSink<Q>& out) {
  if (has_instances(accel))
    run_interleaved<Q, A, InflightTrees::instances>(accel, rays, chunks, out);
  else if (pays_to_prefetch(accel, rays))
    run_interleaved<Q, A, InflightTrees::large>(accel, rays, chunks, out);
  else
    run_interleaved<Q, A, InflightTrees::small>(accel, rays, chunks, out);
}
template <Query Q, class A>
void trace_interleaved(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out) {
  trace_interleaved<Q, A>(accel, rays, BatchChunks::all<A>(rays), out);
}

}  // namespace oktett
