#include "accel/isa/trace_query.h"

namespace oktett {

template <class A>
void TraceFunctions<A>::closest_hit(const Accel& accel, const RaySpan& rays, const HitSpan& hits,
                                    TraceMode mode) {
  trace<Query::closest, A>(accel, rays, hits, mode);
}

template void TraceFunctions<OKTETT_ISA>::closest_hit(const Accel&, const RaySpan&, const HitSpan&,
                                                      TraceMode);

}  // namespace oktett
