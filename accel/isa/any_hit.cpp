#include "accel/isa/trace_query.h"

namespace oktett {

template <class A>
void TraceFunctions<A>::any_hit(const Accel& accel, const RaySpan& rays, std::uint8_t* occluded,
                                TraceMode mode) {
  trace<Query::any, A>(accel, rays, occluded, mode);
}

template void TraceFunctions<OKTETT_ISA>::any_hit(const Accel&, const RaySpan&, std::uint8_t*, TraceMode);

}  // namespace oktett
