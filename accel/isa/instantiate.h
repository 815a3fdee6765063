#pragma once
/// \file Fills an IsaTable for one instruction set: the streams over batches, and single kernels for
/// verification.

#include "accel/all_hits.h"
#include "accel/build_sah.h"
#include "accel/isa/table.h"
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

/// Tiles are worth it only with vector registers, in the width that `automatic` takes.
template <int W, class A>
inline constexpr bool kUsesTiles = !std::is_same_v<A, ScalarIsa> && W >= 8;

/// Rays [begin, begin + kTileRays) as a tile, if they are one.
template <Query Q, class A>
OKTETT_INLINE bool try_tile(const Accel& accel, const RaySpan& rays, std::size_t begin, std::size_t count,
                            const HitSpan* hits, std::uint8_t* occluded) {
  const RaySpan part = rays.part(begin, count);
  const Ray first = part[0], last = part[count - 1];
  Apex apex{first.origin, false};
  if (Q == Query::any && first.origin != last.origin) {
    apex = {first.origin + first.direction * first.tmax, true};
    const Vec3f end = last.origin + last.direction * last.tmax;
    const float scale = max_component(abs(apex.point)) + max_component(abs(first.origin));
    if (!(max_component(abs(end - apex.point)) <= scale * 0x1p-18f)) return false;
  } else if (first.origin != last.origin) {
    return false;
  }
  if constexpr (Q == Query::closest) {
    const HitSpan h = hits->part(begin, count);
    return trace_tile<Q, A>(accel, part, apex, &h, nullptr);
  } else {
    return trace_tile<Q, A>(accel, part, apex, nullptr, occluded + begin);
  }
}

template <int W, class A>
void closest_hit_stream(const Accel& accel, const RaySpan& rays, const HitSpan& hits, TraceMode mode) {
  using F = Simd<float, W, A>;
  RayState<W, A> state;
  for (std::size_t b = 0; b < rays.size; b += W) {
    if (kUsesTiles<W, A> && b % kTileRays == 0 && mode == TraceMode::automatic) {
      const std::size_t count = std::min<std::size_t>(kTileRays, rays.size - b);
      if (try_tile<Query::closest, A>(accel, rays, b, count, &hits, nullptr)) {
        b += kTileRays - W;
        continue;
      }
    }
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
    if (kUsesTiles<W, A> && b % kTileRays == 0 && mode == TraceMode::automatic) {
      const std::size_t count = std::min<std::size_t>(kTileRays, rays.size - b);
      if (try_tile<Query::any, A>(accel, rays, b, count, nullptr, occluded)) {
        b += kTileRays - W;
        continue;
      }
    }
    const RayLanes<F> r = load_span<F>(rays, b);
    const unsigned valid = rays.size - b >= W ? ~0u : (1u << (rays.size - b)) - 1;
    trace_lanes<Query::any>(accel, state, r, state.set(r.o, r.d, r.tmin, r.tmax, accel.bounds) & valid, mode);
    const int count = rays.size - b >= W ? W : static_cast<int>(rays.size - b);
    for (int i = 0; i < count; ++i) occluded[b + i] = state.item[i] != kNoId;
  }
}

/// Calls f<W>() for the packet width that `mode` asks for. Without vector registers every ray goes alone.
template <class A, class Function>
OKTETT_INLINE void with_width(TraceMode mode, Function&& f) {
  if constexpr (std::is_same_v<A, ScalarIsa>) {
    f.template operator()<1>();
  } else {
    if (mode == TraceMode::packet4) return f.template operator()<4>();
    if (mode == TraceMode::packet16) return f.template operator()<16>();
    if (mode == TraceMode::single) return f.template operator()<1>();
    if (std::is_same_v<A, Avx512Isa> && mode == TraceMode::automatic) return f.template operator()<16>();
    f.template operator()<8>();
  }
}

template <class A>
struct IsaCode {
  static void closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits, TraceMode mode) {
    with_width<A>(mode, [&]<int W>() { closest_hit_stream<W, A>(accel, rays, hits, mode); });
  }
  static void any_hit(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded, TraceMode mode) {
    with_width<A>(mode, [&]<int W>() { any_hit_stream<W, A>(accel, rays, occluded, mode); });
  }
  static void all_hits(const Accel& accel, const Ray& ray, HitList& hits) {
    using F = Simd<float, 1, A>;
    RayState<1, A> state;
    if (state.set(broadcast<F>(ray.origin), broadcast<F>(ray.direction), F(ray.tmin), F(ray.tmax),
                  accel.bounds) != 0)
      collect(accel, state, hits);
  }
  static void bin(const BinJob& job) {
    using B = Simd<float, 8, A>;
    for (std::size_t i = job.begin; i < job.end; ++i) {
      const PrimRef& r = job.refs[i];
      const B box = B::load(r.negative_lo);
      for (int axis = 0; axis < 3; ++axis) {
        const int b = bin_of(r, axis, job.origin[axis], job.scale[axis], job.bins);
        float* bin = job.out->box[axis][b].v;
        max(box, B::load(bin)).store(bin);
        ++job.out->count[axis][b];
      }
    }
  }
  static void run_kernel(KernelId id, int width, const KernelRun& run);
};

}  // namespace oktett

#include "accel/isa/run_kernel.h"

namespace oktett {

template <class A>
const IsaTable& make_table() {
  static constexpr IsaTable table = {IsaCode<A>::closest_hit, IsaCode<A>::any_hit, IsaCode<A>::all_hits,
                                     IsaCode<A>::run_kernel, IsaCode<A>::bin};
  return table;
}

}  // namespace oktett
