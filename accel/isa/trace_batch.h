#pragma once
/// \file Batches of rays through one structure: which traversal takes which rays. The choice changes the
/// speed, never a hit.

#include "accel/trace_mode.h"
#include "accel/traverse/beam/traverse_beam.h"
#include "accel/traverse/inflight/interleaved.h"

namespace oktett {

/// Rays run together if all of them keep within about 25 degrees of the first.
template <int W, class A>
OKTETT_INLINE bool is_coherent(const RayLanes<Simd<float, W, A>>& r, unsigned lanes) {
  using F = Simd<float, W, A>;
  const Vec3<F> d = r.d;
  alignas(64) float x[W], y[W], z[W];
  d.x.store(x), d.y.store(y), d.z.store(z);
  const int first = __builtin_ctz(lanes);
  const Vec3<F> axis{F(x[first]), F(y[first]), F(z[first])};
  const F along = fast_dot(d, axis), square = fast_dot(d, d) * fast_dot(axis, axis);
  return (lanes & ~bits((F(0.0f) < along) & (F(0.8f) * square <= along * along))) == 0;
}

/// Writes what ray `i` of `state` has found to position `at`.
template <Query Q, int W, class A>
OKTETT_INLINE void store_hit(const RayState<W, A>& state, int i, const HitSink<Q>& out, std::size_t at) {
  if constexpr (Q == Query::any) {
    out[at] = state.item[i] != kNoId;
  } else {
    const bool hit = state.item[i] != kNoId;
    out.t[at] = hit ? state.tmax[i] : std::numeric_limits<float>::infinity();
    out.u[at] = state.u[i], out.v[at] = state.v[i];
    out.item[at] = state.item[i], out.instance[at] = state.path[i];
  }
}

/// The places of `count` results from `begin` on.
template <Query Q>
OKTETT_INLINE HitSink<Q> sink_from(const HitSink<Q>& out, std::size_t begin, std::size_t count) {
  if constexpr (Q == Query::any)
    return out + begin;
  else
    return out.part(begin, count);
}

/// Rays [begin, end) of a span, which do not run together.
template <Query Q, class A>
OKTETT_INLINE void trace_run(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out,
                             std::size_t begin, std::size_t end) {
  if (begin < end)
    trace_interleaved<Q, A>(accel, rays.part(begin, end - begin), sink_from<Q>(out, begin, end - begin));
}

/// All rays of a span: those that run together in packets of W, the runs between them interleaved.
template <Query Q, int W, class A>
void trace_batch(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, TraceMode mode) {
  using F = Simd<float, W, A>;
  constexpr bool kVectors = W > 1;
  RayState<W, A> state;
  std::size_t run = 0;
  for (std::size_t b = 0; b < rays.size; b += W) {
    const RayLanes<F> r = load_span<F>(rays, b);
    const std::size_t count = rays.size - b < W ? rays.size - b : W;
    if (kVectors && mode == TraceMode::automatic && !is_coherent(r, (1u << count) - 1)) continue;
    if constexpr (kVectors) trace_run<Q, A>(accel, rays, out, run, b);
    run = b + count;
    unsigned lanes = state.set(r.o, r.d, r.tmin, r.tmax, accel.bounds) & ((1u << count) - 1);
    if constexpr (kVectors) {
      if (lanes != 0) trace_packet<Q>(accel, state, lanes);
    } else if (lanes != 0) {
      trace_single<Q>(accel, state);
    }
    for (std::size_t i = 0; i < count; ++i) store_hit<Q>(state, static_cast<int>(i), out, b + i);
  }
  if constexpr (kVectors) trace_run<Q, A>(accel, rays, out, run, rays.size);
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

/// Nodes and leaves that a beam may come to. Where it would be more, the triangles are smaller than the rays
/// are apart, and rays are faster alone; in trees that the caches do not hold, sooner.
template <Query Q>
int max_beam_steps(const Accel& accel) {
  constexpr std::size_t kCached = std::size_t{64} << 20;
  if (tree_bytes(accel) > kCached) return 16;
  return Q == Query::any ? 256 : 384;
}

/// How the rays of a block are traced where no mode is asked for.
enum class Way { beam, packets, interleaved };

/// Traces the rays as a beam if they share a point and take few steps for their number; else says what suits
/// them better.
template <Query Q, class A>
Way try_beam(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, int max_steps) {
  Apex apex;
  if (!common_point<Q>(rays, apex)) return Way::packets;
  BeamOutcome outcome;
  if constexpr (Q == Query::closest)
    outcome = trace_beam<Q, A>(accel, rays, apex, &out, nullptr, max_steps);
  else
    outcome = trace_beam<Q, A>(accel, rays, apex, nullptr, out, max_steps);
  return outcome == BeamOutcome::traced    ? Way::beam
         : outcome == BeamOutcome::no_beam ? Way::packets
                                           : Way::interleaved;
}

/// How `automatic` traces a batch: rays that share a point in beams, others that run together as packets of
/// W, the rest interleaved. Where a beam took too many steps, triangles are smaller than rays are apart; its
/// rays go interleaved, and so do its neighbours untried, twice as many each time, unless the caller insists.
template <Query Q, int W, class A>
void trace_automatic(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, bool insist) {
  const int max_steps = insist ? std::numeric_limits<int>::max() : max_beam_steps<Q>(accel);
  std::size_t begin = 0;  // of a run of rays that wait to be traced the same way
  Way way = Way::packets;
  const auto catch_up = [&](std::size_t end) {
    if (end <= begin) return;
    const RaySpan part = rays.part(begin, end - begin);
    const HitSink<Q> sink = sink_from<Q>(out, begin, end - begin);
    if (way == Way::interleaved)
      trace_interleaved<Q, A>(accel, part, sink);
    else
      trace_batch<Q, W, A>(accel, part, sink, TraceMode::automatic);
  };
  int skip = 0, failures = 0;
  for (std::size_t b = 0; b < rays.size; b += kBeamRays) {
    const std::size_t count = std::min<std::size_t>(kBeamRays, rays.size - b);
    if (skip > 0) {
      --skip;
      continue;
    }
    const Way suits = try_beam<Q, A>(accel, rays.part(b, count), sink_from<Q>(out, b, count), max_steps);
    failures = suits == Way::interleaved ? failures + 1 : 0;
    if (suits == Way::interleaved && !insist) skip = (1 << std::min(failures - 1, 3)) - 1;
    if (suits == way) continue;
    catch_up(b);
    begin = suits == Way::beam ? b + count : b;
    if (suits != Way::beam) way = suits;
  }
  catch_up(rays.size);
}

}  // namespace oktett
