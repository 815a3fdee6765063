#pragma once
/// \file Batches of rays through one structure: which traversal takes which rays. The choice changes the
/// speed, never a hit.

#include "accel/traverse_interleaved.h"
#include "accel/traverse_tile.h"

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
void trace_stream(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, TraceMode mode) {
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
    if (kVectors) {
      if (lanes != 0) trace_packet<Q>(accel, state, lanes);
    } else if (lanes != 0) {
      trace_single<Q>(accel, state, 0);
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

/// True if the rays were a tile and are traced.
template <Query Q, class A>
bool try_tile(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, int max_leaves) {
  Apex apex;
  if (!common_point<Q>(rays, apex)) return false;
  if constexpr (Q == Query::closest)
    return trace_tile<Q, A>(accel, rays, apex, &out, nullptr, max_leaves);
  else
    return trace_tile<Q, A>(accel, rays, apex, nullptr, out, max_leaves);
}

/// In trees above this size the ways even of neighbouring rays part early, and what a ray waits for is
/// memory: all rays go interleaved.
template <Query Q>
inline constexpr std::size_t kScatterBytes = std::size_t{Q == Query::any ? 16 : 96} << 20;

/// How `automatic` traces a batch: rays that share a point in tiles, others that run together as packets of
/// W, the rest interleaved. Where a tile was given up, its neighbours are not tried, twice as many each time,
/// unless the caller insists.
template <Query Q, int W, class A>
void trace_automatic(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, bool insist) {
  if (!insist && tree_bytes(accel) > kScatterBytes<Q>) return trace_interleaved<Q, A>(accel, rays, out);
  std::size_t traced = 0;
  const int max_leaves = insist ? std::numeric_limits<int>::max() : kTileMaxLeaves;
  int skip = 0, failures = 0;
  const auto catch_up = [&](std::size_t end) {
    if (end > traced)
      trace_stream<Q, W, A>(accel, rays.part(traced, end - traced), sink_from<Q>(out, traced, end - traced),
                            TraceMode::automatic);
  };
  for (std::size_t b = 0; b < rays.size; b += kTileRays) {
    const std::size_t count = std::min<std::size_t>(kTileRays, rays.size - b);
    if (skip > 0) {
      --skip;
    } else if (try_tile<Q, A>(accel, rays.part(b, count), sink_from<Q>(out, b, count), max_leaves)) {
      catch_up(b);
      traced = b + count;
      failures = 0;
    } else {
      skip = insist ? 0 : (1 << std::min(failures++, 3)) - 1;
    }
  }
  catch_up(rays.size);
}

}  // namespace oktett
