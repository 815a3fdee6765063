#include "accel/isa/trace_batch.h"

namespace oktett {

template void trace<Query::closest, OKTETT_ISA>(const Accel&, const RaySpan&, const HitSink<Query::closest>&,
                                                TraceMode);

template Hit trace_one<Query::closest, OKTETT_ISA>(const Accel&, const Ray&);

}  // namespace oktett
