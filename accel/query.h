#pragma once
/// \file The queries of accel/accel.h with a prescribed traversal, for verification and benchmarks.

#include "accel/accel.h"

namespace oktett {

/// The traversal that a query uses. Hits have the same bits in every mode; only the speed differs. The scalar
/// set traces every ray alone; the others have packets of 8 rays, AVX-512 also of 16. Where a set lacks
/// packets of 16, those of 8 are used.
enum class TraceMode : std::uint8_t {
  automatic,    ///< beams for rays that share a point, packets for other coherent rays, the rest interleaved;
                ///< in batches of a few rays, each ray alone
  single,       ///< one ray after the other
  interleaved,  ///< single rays, many in flight (without vector registers: like `single`)
  packet8,
  packet16,
  beam,  ///< like automatic, but no beam is given up, however small the triangles
};

void closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits, Isa isa, TraceMode mode);
void any_hit(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded, Isa isa, TraceMode mode);

}  // namespace oktett
