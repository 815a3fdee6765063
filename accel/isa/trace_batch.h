#pragma once
/// \file Batches of rays through one structure, in the mode that is given.

#include <algorithm>

#include "accel/traverse/inflight/solo.h"
#include "accel/traverse/packet.h"

namespace oktett {

template <Query Q, class A>
OKTETT_INLINE HitWithNormal trace_alone(const Accel& accel, const Ray& ray) {
  if constexpr (!std::is_same_v<A, ScalarIsa>) {
    NoJudge all;
    SoloTraversal<Q, A> way(accel, ray, all);
    if (OKTETT_LIKELY(way.is_tame())) return way.run();
  }
  return {trace_exact<Q, A>(accel, ray)};
}

template <Query Q, class A>
OKTETT_NOINLINE Hit trace_one(const Accel& accel, const Ray& ray) {
  return trace_alone<Q, A>(accel, ray);
}

template <class A>
OKTETT_NOINLINE HitWithNormal trace_one_with_normal(const Accel& accel, const Ray& ray) {
  return trace_alone<Query::closest, A>(accel, ray);
}

/// All rays, one after the other.
template <Query Q, class A>
void trace_each(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out) {
  for (std::size_t i = 0; i < rays.size; ++i) out.set(i, trace_one<Q, A>(accel, rays[i]));
}

/// All rays in packets of W.
template <Query Q, int W, class A>
void trace_packets(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out) {
  RayState<W, A> state;
  for (std::size_t b = 0; b < rays.size; b += W)
    trace_packet_at<Q, W, A>(accel, load_span<Simd<float, W, A>>(rays, b), b,
                             std::min<std::size_t>(rays.size - b, W), state, out);
}

/// In batches of up to this many rays, each ray is traced alone.
inline constexpr std::size_t kAloneRays = 4;

template <Query Q, class A>
void trace(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, TraceMode mode) {
  if constexpr (std::is_same_v<A, ScalarIsa>) {
    trace_each<Q, A>(accel, rays, out);
  } else {
    switch (mode) {
      case TraceMode::automatic:
        if (rays.size <= kAloneRays) return trace_each<Q, A>(accel, rays, out);
        return trace_mixed<Q, A>(accel, rays, out, false);
      case TraceMode::beam:
        return trace_mixed<Q, A>(accel, rays, out, true);
      case TraceMode::single:
        return trace_each<Q, A>(accel, rays, out);
      case TraceMode::interleaved:
        return trace_interleaved<Q, A>(accel, rays, BatchChunks::all<A>(rays), out);
      case TraceMode::packet8:
        return trace_packets<Q, 8, A>(accel, rays, out);
      case TraceMode::packet16:
        return trace_packets<Q, kChunkRays<A>, A>(accel, rays, out);
    }
  }
}

}  // namespace oktett
