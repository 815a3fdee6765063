#pragma once
/// \file A query over a batch of rays, for one instruction set.

#include "accel/isa/trace_batch.h"
#include "accel/trace_code.h"

namespace oktett {

/// The functions of TraceCode, each defined in a unit of its own.
template <class A>
struct TraceFunctions {
  static void closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits, TraceMode mode);
  static void any_hit(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded, TraceMode mode);
  static void all_hits(const Accel& accel, const Ray& ray, HitList& hits);
};

/// Calls f<W>() for the packet width that `mode` asks for. Without vector registers every ray goes alone.
template <class A, class Function>
OKTETT_INLINE void with_width(TraceMode mode, Function&& f) {
  if constexpr (std::is_same_v<A, ScalarIsa>) {
    f.template operator()<1>();
  } else {
    if (mode == TraceMode::packet4) return f.template operator()<4>();
    if (mode == TraceMode::packet16) return f.template operator()<16>();
    if (mode == TraceMode::single) return f.template operator()<1>();
    if (std::is_same_v<A, Avx512Isa> && mode != TraceMode::packet8) return f.template operator()<16>();
    f.template operator()<8>();
  }
}

template <Query Q, class A>
void trace(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, TraceMode mode) {
  if constexpr (!std::is_same_v<A, ScalarIsa>)
    if (mode == TraceMode::interleaved) return trace_interleaved<Q, A>(accel, rays, out);
  with_width<A>(mode, [&]<int W>() {
    if constexpr (W > 1)
      if (mode == TraceMode::automatic || mode == TraceMode::beam)
        return trace_automatic<Q, W, A>(accel, rays, out, mode == TraceMode::beam);
    trace_batch<Q, W, A>(accel, rays, out, mode);
  });
}

}  // namespace oktett
