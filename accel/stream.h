#pragma once
/// \file Batches of rays through one structure: which traversal takes which rays. The choice changes the
/// speed, never a hit.

#include "accel/sort_tiles.h"

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

/// Fewer rays than this are not worth sorting.
inline constexpr std::size_t kLeastSorted = 64;

/// How `automatic` traces a batch: rays that start at one point in tiles, the rest as packets.
template <int W, class A>
void closest_hit_automatic(const Accel& accel, const RaySpan& rays, const HitSpan& hits) {
  std::size_t waiting = 0;  // rays before this are traced
  const auto catch_up = [&](std::size_t end) {
    if (end > waiting)
      closest_hit_stream<W, A>(accel, rays.part(waiting, end - waiting), hits.part(waiting, end - waiting),
                               TraceMode::automatic);
  };
  for (std::size_t b = 0; b < rays.size; b += kTileRays) {
    const std::size_t count = std::min<std::size_t>(kTileRays, rays.size - b);
    const RaySpan part = rays.part(b, count);
    if (part[0].origin != part[count - 1].origin) continue;
    const HitSpan out = hits.part(b, count);
    if (!trace_tile<Query::closest, A>(accel, part, {part[0].origin, false}, &out, nullptr)) continue;
    catch_up(b);
    waiting = b + count;
  }
  catch_up(rays.size);
}

/// The same for occlusion; rays that end in one point are sorted first.
template <int W, class A>
void any_hit_automatic(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded) {
  std::size_t waiting = 0;
  const auto catch_up = [&](std::size_t end) {
    if (end > waiting)
      any_hit_stream<W, A>(accel, rays.part(waiting, end - waiting), occluded + waiting, TraceMode::automatic);
  };
  for (std::size_t b = 0; b < rays.size; b += kTileRays) {
    const std::size_t count = std::min<std::size_t>(kTileRays, rays.size - b);
    const RaySpan part = rays.part(b, count);
    if (part[0].origin != part[count - 1].origin) continue;
    if (!trace_tile<Query::any, A>(accel, part, {part[0].origin, false}, nullptr, occluded + b)) continue;
    catch_up(b);
    waiting = b + count;
  }
  catch_up(rays.size);
}

/// Rays that end at the apex, up to kSortedRays.
template <int W, class A>
OKTETT_NOINLINE void any_hit_sorted(const Accel& accel, const RaySpan& rays, const Apex& apex, std::uint8_t* occluded) {
  std::uint16_t order[kSortedRays];
  std::uint8_t found[kSortedRays];
  SortedRays columns;
  sort_by_end<A>(rays, order);
  columns.gather(rays, order);
  const RaySpan sorted = columns.span(rays.size);
  for (std::size_t b = 0; b < rays.size; b += kTileRays) {
    const std::size_t count = std::min<std::size_t>(kTileRays, rays.size - b);
    const RaySpan part = sorted.part(b, count);
    if (!trace_tile<Query::any, A>(accel, part, apex, nullptr, found + b))
      any_hit_stream<W, A>(accel, part, found + b, TraceMode::automatic);
  }
  for (std::size_t i = 0; i < rays.size; ++i) occluded[order[i]] = found[i];
}

template <int W, class A>
void any_hit_batch(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded) {
  for (std::size_t b = 0; b < rays.size; b += kSortedRays) {
    const RaySpan part = rays.part(b, std::min(kSortedRays, rays.size - b));
    Apex apex;
    if (part.size >= kLeastSorted && part[0].origin != part[part.size - 1].origin && common_end(part, apex))
      any_hit_sorted<W, A>(accel, part, apex, occluded + b);
    else
      any_hit_automatic<W, A>(accel, part, occluded + b);
  }
}

}  // namespace oktett
