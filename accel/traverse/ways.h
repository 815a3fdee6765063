#pragma once
/// \file The ways of rays through a structure. Each is compiled in units of its own, one for each query:
/// together they would take minutes. Without vector registers every ray goes alone, and they do nothing.

#include "accel/code.h"
#include "accel/ray_state.h"

namespace oktett {

/// The rays in `lanes` against everything, in packets of rays that share an octant and the axis of greatest
/// direction. The other lanes must contain finite numbers.
template <Query Q, int W, class A>
void trace_packet(const Accel& accel, RayState<W, A>& r, unsigned lanes);

/// The rays from position `b` on, `r`, in one packet.
template <Query Q, int W, class A>
OKTETT_INLINE void trace_packet_at(const Accel& accel, const RayLanes<Simd<float, W, A>>& r, std::size_t b,
                                   std::size_t count, RayState<W, A>& state, const HitSink<Q>& out) {
  const unsigned lanes = state.set(r.o, r.d, r.tmin, r.tmax, accel.bounds) & ((1u << count) - 1);
  if (lanes != 0) trace_packet<Q>(accel, state, lanes);
  for (std::size_t i = 0; i < count; ++i) out.set(b + i, state.hit(static_cast<int>(i)));
}

/// The rays in `lanes` against a leaf of the table.
template <Query Q, int W, class A>
void table_leaf_packet(const Accel& accel, const LeafEntry& leaf, RayState<W, A>& r, unsigned lanes);

/// Which rays of a batch are traced: all, or only some chunks of kChunkRays<A> neighbours. The last chunk of
/// a batch may be shorter.
struct BatchChunks {
  const std::uint32_t* first;  ///< of each chunk, the position of its first ray; null: all rays
  std::size_t count;           ///< of chunks

  template <class A>
  static BatchChunks all(const RaySpan& rays) {
    return {nullptr, (rays.size + kChunkRays<A> - 1) / kChunkRays<A>};
  }
};

/// The rays in `chunks` against everything, interleaved; each hit is at the position of its ray.
template <Query Q, class A>
void trace_interleaved(const Accel& accel, const RaySpan& rays, const BatchChunks& chunks,
                       const HitSink<Q>& out);

/// All rays: those that share a point in beams, other coherent rays in packets, the rest interleaved. With
/// `insist` no beam is given up.
template <Query Q, class A>
void trace_mixed(const Accel& accel, const RaySpan& rays, const HitSink<Q>& out, bool insist);

}  // namespace oktett
