#include "accel/isa/trace_batch.h"

namespace oktett {

template void trace<Query::closest, OKTETT_ISA>(const Accel&, const RaySpan&, const HitSink<Query::closest>&,
                                                TraceMode);

}  // namespace oktett
