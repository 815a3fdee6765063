#include "accel/isa/mixed_batch.h"

namespace oktett {

template void trace_mixed<Query::closest, OKTETT_ISA>(const Accel&, const RaySpan&,
                                                      const HitSink<Query::closest>&, bool);

}  // namespace oktett
