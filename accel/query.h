#pragma once
/// \file The queries of accel/accel.h with a prescribed traversal, for verification and benchmarks.

#include "accel/accel.h"
#include "accel/trace_mode.h"

namespace oktett {

void closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits, Isa isa, TraceMode mode);
void any_hit(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded, Isa isa, TraceMode mode);

}  // namespace oktett
