#pragma once
/// \file Batches of rays of all kinds: which traversal takes which rays. The choice changes the speed, never
/// a hit.

#include <algorithm>
#include <limits>

#include "accel/traverse/beam/traverse_beam.h"
#include "accel/traverse/ways.h"

namespace oktett {

/// How far apart the rays of a packet may start along each axis: a part of the scene's longest edge. Beyond
/// that, rays of one direction meet different nodes, and interleaved ones are faster.
OKTETT_INLINE float packet_reach(const Accel& accel) {
  constexpr float kPart = 1.0f / 16;
  const float reach = max_component(accel.bounds.extent()) * kPart;
  return reach > 0 ? reach : std::numeric_limits<float>::infinity();
}

/// Rays are coherent if all of them keep within about 25 degrees of the first and start within `reach` of it.
template <int W, class A>
OKTETT_INLINE bool is_coherent(const RayLanes<Simd<float, W, A>>& r, float reach, unsigned lanes) {
  using F = Simd<float, W, A>;
  const Vec3<F> d = r.d;
  alignas(64) float x[W], y[W], z[W];
  d.x.store(x), d.y.store(y), d.z.store(z);
  const int first = __builtin_ctz(lanes);
  auto near = F(0.0f) <= F(0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    alignas(64) float start[W];
    r.o[axis].store(start);
    near = near & (abs(r.o[axis] - F(start[first])) <= F(reach));
  }
  const Vec3<F> axis{F(x[first]), F(y[first]), F(z[first])};
  const F along = fast_dot(d, axis), square = fast_dot(d, d) * fast_dot(axis, axis);
  return (lanes & ~bits(near & (F(0.0f) < along) & (F(0.8f) * square <= along * along))) == 0;
}

/// The point that the rays seem to share: where all start, or, for shadow rays, where all end.
template <Query Q>
OKTETT_INLINE bool common_point(const RaySpan& rays, Apex& apex) {
  const Vec3f first = rays[0].origin;
  apex = {first, false};
  if (first == rays[rays.size - 1].origin) return true;
  if (Q != Query::any) return false;
  const auto end = [&](std::size_t i) {
    const Ray r = rays[i];
    return Vec3d(r.origin) + Vec3d(r.direction) * static_cast<double>(r.tmax);
  };
  const Vec3d middle = end(rays.size / 2);
  const double near = 0x1p-20 * (max_component(abs(middle)) + max_component(abs(Vec3d(first))));
  apex = {Vec3f(middle), true};
  return max_component(abs(end(0) - middle)) <= near &&
         max_component(abs(end(rays.size - 1) - middle)) <= near;
}

/// Nodes and leaves that a beam may visit before it is given up. Where it would be more, triangles are
/// smaller than the distance between rays, and interleaved rays are faster; in trees that the caches do not
/// hold, sooner.
template <Query Q>
int max_beam_steps(const Accel& accel) {
  constexpr std::size_t kCached = std::size_t{64} << 20;
  if (tree_bytes(accel) > kCached) return 16;
  return Q == Query::any ? 256 : 384;
}

/// Batches of fewer rays are no beams: what a beam costs before its first node is more than it saves.
inline constexpr std::size_t kLeastBeamRays = 64;

/// The only leaf of a structure that has but one, of exact surfaces.
OKTETT_INLINE const LeafEntry* only_exact_leaf(const Accel& accel) {
  if (!accel.root.is_leaf() || accel.root.is_none() || accel.root.is_triangles()) return nullptr;
  const LeafEntry& leaf = accel.leaves[accel.root.table_index()];
  return is_exact(leaf.kind) && accel.unbounded.empty() ? &leaf : nullptr;
}

/// All rays against a leaf of exact surfaces, as many at once as such surfaces solve.
template <Query Q, class A>
void trace_exact_leaf(const Accel& accel, const LeafEntry& leaf, const RaySpan& rays, const HitSink<Q>& out) {
  constexpr int W = ExactCode<A>::kLanes;
  RayState<W, A> state;
  for (std::size_t b = 0; b < rays.size; b += W) {
    const auto r = load_span<Simd<float, W, A>>(rays, b);
    const std::size_t count = std::min<std::size_t>(rays.size - b, W);
    const unsigned lanes = state.set_rays(r.o, r.d, r.tmin, r.tmax) & ((1u << count) - 1);
    if (lanes != 0) leaf_exact(accel, leaf, state, lanes);
    if (count == W)
      out.clear(b, W);  // the compiler knows the size
    else
      out.clear(b, count);
    for (unsigned found = found_lanes(state, lanes); found != 0; found &= found - 1) {
      const int i = __builtin_ctz(found);
      out.set(b + static_cast<std::size_t>(i), state.hit(i));
    }
  }
}

/// Traces a batch: each part of it in the way that suits its rays. Rays that are to go interleaved wait until
/// finish(), so that all of them go together: interleaved rays are slow while few of them are left.
template <Query Q, class A>
class MixedBatch {
 public:
  MixedBatch(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out)
      : accel_(accel), rays_(rays), out_(out), reach_(packet_reach(accel)) {}

  /// All rays: those that share a point in beams, all others by without_beams(). When a beam is given up, its
  /// rays go interleaved. When several in a row are, the next rays go interleaved without a trial: those of
  /// one beam after the second, of three after the third, then of seven. With `insist` no beam is given up.
  OKTETT_NOINLINE void beams(bool insist, BeamInstances<Q, A>* instances) {
    const int max_steps = insist ? kAnySteps : max_beam_steps<Q>(accel_);
    int skip = 0, failures = 0;
    for (std::size_t b = 0; b < rays_.size; b += kBeamRays) {
      const std::size_t count = std::min<std::size_t>(kBeamRays, rays_.size - b);
      if (skip > 0) {
        --skip;
        interleave(b, count);
        continue;
      }
      const RaySpan part = rays_.part(b, count);
      const RaySpan next = rays_.part(b + count, std::min<std::size_t>(kBeamRays, rays_.size - b - count));
      Apex apex;
      const BeamOutcome outcome =
          common_point<Q>(part, apex)
              ? trace_beam<Q, A>(accel_, part, apex, out_.part(b, count), max_steps, next, instances)
              : BeamOutcome::no_beam;
      failures = outcome == BeamOutcome::given_up ? failures + 1 : 0;
      if (failures > 0) skip = (1 << std::min(failures - 1, 3)) - 1;
      if (outcome == BeamOutcome::given_up)
        interleave(b, count);
      else if (outcome == BeamOutcome::no_beam)
        without_beams(b, count);
    }
  }

  /// `count` rays from position `begin` on that make no beam: together against the leaf if there is only one,
  /// of exact surfaces; else in packets if they are coherent, and interleaved if not. Shadow rays among
  /// instances are always interleaved: in an instance, packets of them have few rays at a time.
  void without_beams(std::size_t begin, std::size_t count) {
    if (const LeafEntry* leaf = only_exact_leaf(accel_))
      trace_exact_leaf<Q, A>(accel_, *leaf, rays_.part(begin, count), out_.part(begin, count));
    else if (Q == Query::any && has_instances(accel_))
      interleave(begin, count);
    else
      packets(begin, count);
  }

  /// Traces the rays that wait.
  void finish() {
    if (waiting_count_ > 0) trace_interleaved<Q, A>(accel_, rays_, {waiting_, waiting_count_}, out_);
    waiting_count_ = 0;
  }

 private:
  static constexpr int kWidth = kChunkRays<A>;
  static_assert(kBeamRays % kWidth == 0, "parts of a batch begin where chunks begin");

  /// Coherent rays in packets; all others wait.
  OKTETT_NOINLINE void packets(std::size_t begin, std::size_t count) {
    for (std::size_t b = begin; b < begin + count; b += kWidth) {
      const auto r = load_span<Simd<float, kWidth, A>>(rays_, b);
      const std::size_t present = std::min<std::size_t>(begin + count - b, kWidth);
      if (is_coherent(r, reach_, (1u << present) - 1))
        trace_packet_at<Q, kWidth, A>(accel_, r, b, present, packet_, out_);
      else
        wait(b);
    }
  }

  void interleave(std::size_t begin, std::size_t count) {
    for (std::size_t b = begin; b < begin + count; b += kWidth) wait(b);
  }

  void wait(std::size_t begin) {
    waiting_[waiting_count_++] = static_cast<std::uint32_t>(begin);
    if (waiting_count_ == kMostWaiting) finish();
  }

  static constexpr std::size_t kMostWaiting = 512;

  const Accel& accel_;
  const RaySpan rays_;
  const HitSink<Q> out_;
  const float reach_;
  RayState<kWidth, A> packet_;
  std::uint32_t waiting_[kMostWaiting];  ///< positions at which chunks begin
  std::size_t waiting_count_ = 0;
};

template <Query Q, class A>
void trace_mixed(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, bool insist) {
  if constexpr (!std::is_same_v<A, ScalarIsa>) {
    MixedBatch<Q, A> batch(accel, rays, out);
    if (rays.size < kLeastBeamRays && !insist) {
      batch.without_beams(0, rays.size);
    } else if (has_instances(accel)) {
      BeamInstances<Q, A> instances(accel);
      batch.beams(insist, &instances);
    } else {
      batch.beams(insist, nullptr);
    }
    batch.finish();
  }
}

}  // namespace oktett
