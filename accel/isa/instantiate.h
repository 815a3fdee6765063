#pragma once
/// \file Fills an IsaTable for one instruction set: the streams over batches, and single kernels for
/// verification.

#include "accel/all_hits.h"
#include "accel/build_kernels.h"
#include "accel/isa/table.h"
#include "accel/stream.h"

namespace oktett {

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

template <class A>
struct IsaCode {
  template <Query Q>
  static void trace(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, TraceMode mode) {
    if constexpr (!std::is_same_v<A, ScalarIsa>)
      if (mode == TraceMode::interleaved) return trace_interleaved<Q, A>(accel, rays, out);
    with_width<A>(mode, [&]<int W>() {
      if constexpr (W > 1)
        if (mode == TraceMode::automatic || mode == TraceMode::tile)
          return trace_automatic<Q, W, A>(accel, rays, out, mode == TraceMode::tile);
      trace_stream<Q, W, A>(accel, rays, out, mode);
    });
  }
  static void closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits, TraceMode mode) {
    trace<Query::closest>(accel, rays, hits, mode);
  }
  static void any_hit(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded, TraceMode mode) {
    trace<Query::any>(accel, rays, occluded, mode);
  }
  static void all_hits(const Accel& accel, const Ray& ray, HitList& hits) {
    using F = Simd<float, 1, A>;
    RayState<1, A> state;
    if (state.set(broadcast<F>(ray.origin), broadcast<F>(ray.direction), F(ray.tmin), F(ray.tmax),
                  accel.bounds) != 0)
      collect(accel, state, hits);
  }
  static void run_kernel(KernelId id, int width, const KernelRun& run);
  static void run_roots(RootsKernel id, const RootsRun& run);
};

}  // namespace oktett

#include "accel/isa/run_kernel.h"
#include "accel/isa/run_roots.h"
#include "accel/isa/shape_surfaces.h"
#include "accel/isa/surface_code.h"
#include "accel/isa/view_code.h"

namespace oktett {

template <class A>
const IsaTable& isa_code() {
  static constexpr IsaTable table = {
      IsaCode<A>::closest_hit,      IsaCode<A>::any_hit,   IsaCode<A>::all_hits,    IsaCode<A>::run_kernel,
      build_kernels<A>(),           IsaCode<A>::run_roots, view_directions_code<A>, mesh_surfaces_code<A>,
      closed_form_surfaces_code<A>, ExactCode<A>::surfaces};
  return table;
}

}  // namespace oktett
