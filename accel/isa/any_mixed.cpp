#include "accel/isa/mixed_batch.h"

namespace oktett {

template void trace_mixed<Query::any, OKTETT_ISA>(const Accel&, const RaySpan&, const HitSink<Query::any>&,
                                                  bool);

}  // namespace oktett
