#pragma once
/// \file Batches of rays through one structure: which traversal takes which rays. The choice changes the
/// speed, never a hit.

#include <algorithm>
#include <limits>

#include "accel/isa/trace_query.h"
#include "accel/traverse/beam/traverse_beam.h"
#include "accel/traverse/inflight/interleaved.h"
#include "accel/traverse/inflight/solo.h"

namespace oktett {

/// Rays of a packet where the mode does not say.
template <class A>
inline constexpr int kPacketRays = std::is_same_v<A, Avx512Isa> ? 16 : 8;

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

template <Query Q, class A>
OKTETT_NOINLINE Hit trace_one(const Accel& accel, const Ray& ray) {
  if constexpr (std::is_same_v<A, ScalarIsa>)
    return trace_exact<Q, A>(accel, ray);
  else
    return SoloTraversal<Q, A>(accel, ray).run();
}

/// All rays, one after the other.
template <Query Q, class A>
void trace_each(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out) {
  for (std::size_t i = 0; i < rays.size; ++i) out.set(i, trace_one<Q, A>(accel, rays[i]));
}

/// All rays in packets of W. With `coherent_only`, packets whose rays are not coherent go interleaved
/// instead, together with their neighbours of this kind.
template <Query Q, int W, class A>
void trace_packets(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, bool coherent_only) {
  using F = Simd<float, W, A>;
  std::size_t begin = 0;  // of the rays that are to go interleaved
  const auto interleave_until = [&](std::size_t end) {
    if (begin < end)
      trace_interleaved<Q, A>(accel, rays.part(begin, end - begin), out.part(begin, end - begin));
  };
  RayState<W, A> state;
  const float reach = packet_reach(accel);
  for (std::size_t b = 0; b < rays.size; b += W) {
    const RayLanes<F> r = load_span<F>(rays, b);
    const std::size_t count = std::min<std::size_t>(rays.size - b, W);
    const unsigned present = (1u << count) - 1;
    if (coherent_only && !is_coherent(r, reach, present)) continue;
    interleave_until(b);
    begin = b + count;
    const unsigned lanes = state.set(r.o, r.d, r.tmin, r.tmax, accel.bounds) & present;
    if (lanes != 0) trace_packet<Q>(accel, state, lanes);
    for (std::size_t i = 0; i < count; ++i) out.set(b + i, state.hit(static_cast<int>(i)));
  }
  interleave_until(rays.size);
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
/// In batches of up to this many rays, each ray is traced alone.
inline constexpr std::size_t kAloneRays = 4;

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

/// Rays that make no beam: together against the leaf if there is only one, of exact surfaces; else in
/// packets if they are coherent, and interleaved if not. Shadow rays among instances are always interleaved:
/// in an instance, packets of them have few rays at a time.
template <Query Q, class A>
void trace_without_beams(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out) {
  if (const LeafEntry* leaf = only_exact_leaf(accel))
    trace_exact_leaf<Q, A>(accel, *leaf, rays, out);
  else if (Q == Query::any && has_instances(accel))
    trace_interleaved<Q, A>(accel, rays, out);
  else
    trace_packets<Q, kPacketRays<A>, A>(accel, rays, out, true);
}

/// Rays that share a point in beams, all others by trace_without_beams(). When a beam is given up, its rays
/// are traced interleaved. When several in a row are, the next rays go interleaved without a trial: those of
/// one beam after the second, of three after the third, then of seven. With `insist` no beam is given up.
template <Query Q, class A>
OKTETT_NOINLINE void trace_beams(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, bool insist,
                                 BeamInstances<Q, A>* instances) {
  const int max_steps = insist ? kAnySteps : max_beam_steps<Q>(accel);
  // Rays from `begin` on wait to be traced the same way, so that long runs go interleaved together.
  std::size_t begin = 0;
  BeamOutcome waiting = BeamOutcome::no_beam;
  const auto catch_up = [&](std::size_t end) {
    if (end <= begin) return;
    const RaySpan part = rays.part(begin, end - begin);
    const HitSink<Q> sink = out.part(begin, end - begin);
    if (waiting == BeamOutcome::given_up)
      trace_interleaved<Q, A>(accel, part, sink);
    else
      trace_without_beams<Q, A>(accel, part, sink);
  };
  int skip = 0, failures = 0;
  for (std::size_t b = 0; b < rays.size; b += kBeamRays) {
    if (skip > 0) {
      --skip;
      continue;
    }
    const std::size_t count = std::min<std::size_t>(kBeamRays, rays.size - b);
    const RaySpan part = rays.part(b, count);
    const RaySpan next = rays.part(b + count, std::min<std::size_t>(kBeamRays, rays.size - b - count));
    Apex apex;
    const BeamOutcome outcome =
        common_point<Q>(part, apex)
            ? trace_beam<Q, A>(accel, part, apex, out.part(b, count), max_steps, next, instances)
            : BeamOutcome::no_beam;
    failures = outcome == BeamOutcome::given_up ? failures + 1 : 0;
    if (failures > 0) skip = (1 << std::min(failures - 1, 3)) - 1;
    if (outcome == waiting) continue;
    catch_up(b);
    begin = outcome == BeamOutcome::traced ? b + count : b;
    if (outcome != BeamOutcome::traced) waiting = outcome;
  }
  catch_up(rays.size);
}

template <Query Q, class A>
OKTETT_NOINLINE void trace_beams_inside(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out,
                                        bool insist) {
  BeamInstances<Q, A> instances(accel);
  trace_beams<Q, A>(accel, rays, out, insist, &instances);
}

/// Beams where rays share a point, in structures with instances or without.
template <Query Q, class A>
void trace_automatic(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, bool insist) {
  if (has_instances(accel))
    trace_beams_inside<Q, A>(accel, rays, out, insist);
  else
    trace_beams<Q, A>(accel, rays, out, insist, nullptr);
}

template <Query Q, class A>
void trace(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, TraceMode mode) {
  if constexpr (std::is_same_v<A, ScalarIsa>) {
    trace_each<Q, A>(accel, rays, out);
  } else {
    switch (mode) {
      case TraceMode::automatic:
        if (rays.size <= kAloneRays) return trace_each<Q, A>(accel, rays, out);
        if (rays.size < kLeastBeamRays) return trace_without_beams<Q, A>(accel, rays, out);
        return trace_automatic<Q, A>(accel, rays, out, false);
      case TraceMode::beam:
        return trace_automatic<Q, A>(accel, rays, out, true);
      case TraceMode::single:
        return trace_each<Q, A>(accel, rays, out);
      case TraceMode::interleaved:
        return trace_interleaved<Q, A>(accel, rays, out);
      case TraceMode::packet8:
        return trace_packets<Q, 8, A>(accel, rays, out, false);
      case TraceMode::packet16:
        return trace_packets<Q, kPacketRays<A>, A>(accel, rays, out, false);
    }
  }
}

}  // namespace oktett
