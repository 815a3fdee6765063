#include "accel/isa/trace_batch.h"

namespace oktett {

template void trace<Query::any, OKTETT_ISA>(const Accel&, const RaySpan&, const HitSink<Query::any>&,
                                            TraceMode);

template Hit trace_one<Query::any, OKTETT_ISA>(const Accel&, const Ray&);

}  // namespace oktett
