#pragma once
/// \file Batches of rays through one structure: which traversal takes which rays. The choice changes the
/// speed, never a hit.

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

template <Query Q, int W, class A>
OKTETT_INLINE void trace_lanes(const Accel& accel, RayState<W, A>& state,
                               const RayLanes<Simd<float, W, A>>& rays, unsigned lanes, TraceMode mode) {
  if (lanes == 0) return;
  if (mode == TraceMode::single || W == 1 || (mode == TraceMode::automatic && !is_coherent(rays, lanes))) {
    for (; lanes != 0; lanes &= lanes - 1) trace_single<Q>(accel, state, __builtin_ctz(lanes));
  } else {
    trace_packet<Q>(accel, state, lanes);
  }
}

template <int W, class A>
void closest_hit_stream(const Accel& accel, const RaySpan& rays, const HitSpan& hits, TraceMode mode) {
  using F = Simd<float, W, A>;
  RayState<W, A> state;
  for (std::size_t b = 0; b < rays.size; b += W) {
    const RayLanes<F> r = load_span<F>(rays, b);
    const unsigned valid = rays.size - b >= W ? ~0u : (1u << (rays.size - b)) - 1;
    trace_lanes<Query::closest>(accel, state, r, state.set(r.o, r.d, r.tmin, r.tmax, accel.bounds) & valid,
                                mode);
    const int count = rays.size - b >= W ? W : static_cast<int>(rays.size - b);
    for (int i = 0; i < count; ++i) {
      const bool hit = state.item[i] != kNoId;
      hits.t[b + i] = hit ? state.tmax[i] : std::numeric_limits<float>::infinity();
      hits.u[b + i] = state.u[i], hits.v[b + i] = state.v[i];
      hits.item[b + i] = state.item[i], hits.instance[b + i] = state.path[i];
    }
  }
}

template <int W, class A>
void any_hit_stream(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded, TraceMode mode) {
  using F = Simd<float, W, A>;
  RayState<W, A> state;
  for (std::size_t b = 0; b < rays.size; b += W) {
    const RayLanes<F> r = load_span<F>(rays, b);
    const unsigned valid = rays.size - b >= W ? ~0u : (1u << (rays.size - b)) - 1;
    trace_lanes<Query::any>(accel, state, r, state.set(r.o, r.d, r.tmin, r.tmax, accel.bounds) & valid, mode);
    const int count = rays.size - b >= W ? W : static_cast<int>(rays.size - b);
    for (int i = 0; i < count; ++i) occluded[b + i] = state.item[i] != kNoId;
  }
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

/// Where the results of a query go.
template <Query Q>
struct Results;
template <>
struct Results<Query::closest> {
  HitSpan hits;
  Results part(std::size_t begin, std::size_t count) const { return {hits.part(begin, count)}; }
};
template <>
struct Results<Query::any> {
  std::uint8_t* occluded;
  Results part(std::size_t begin, std::size_t) const { return {occluded + begin}; }
};

template <Query Q, int W, class A>
void trace_stream(const Accel& accel, const RaySpan& rays, const Results<Q>& results, TraceMode mode) {
  if constexpr (Q == Query::closest)
    closest_hit_stream<W, A>(accel, rays, results.hits, mode);
  else
    any_hit_stream<W, A>(accel, rays, results.occluded, mode);
}

/// True if the rays were a tile and are traced.
template <Query Q, class A>
bool try_tile(const Accel& accel, const RaySpan& rays, const Results<Q>& results, int max_leaves) {
  Apex apex;
  if (!common_point<Q>(rays, apex)) return false;
  if constexpr (Q == Query::closest)
    return trace_tile<Q, A>(accel, rays, apex, &results.hits, nullptr, max_leaves);
  else
    return trace_tile<Q, A>(accel, rays, apex, nullptr, results.occluded, max_leaves);
}

/// How `automatic` traces a batch: rays that share a point in tiles, the rest as packets. Where a tile was
/// given up, its neighbours are not tried, twice as many each
/// time, unless the caller insists.
template <Query Q, int W, class A>
void trace_automatic(const Accel& accel, const RaySpan& rays, const Results<Q>& results, bool insist) {
  std::size_t traced = 0;
  const int max_leaves = insist ? std::numeric_limits<int>::max() : kTileMaxLeaves;
  int skip = 0, failures = 0;
  const auto catch_up = [&](std::size_t end) {
    if (end > traced)
      trace_stream<Q, W, A>(accel, rays.part(traced, end - traced), results.part(traced, end - traced),
                            TraceMode::automatic);
  };
  for (std::size_t b = 0; b < rays.size; b += kTileRays) {
    const std::size_t count = std::min<std::size_t>(kTileRays, rays.size - b);
    if (skip > 0) {
      --skip;
    } else if (try_tile<Q, A>(accel, rays.part(b, count), results.part(b, count), max_leaves)) {
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
