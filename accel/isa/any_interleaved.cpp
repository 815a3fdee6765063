#include "accel/traverse/inflight/interleaved.h"

namespace oktett {

template void trace_interleaved<Query::any, OKTETT_ISA>(const Accel&, const RaySpan&, const BatchChunks&,
                                                        const HitSink<Query::any>&);

}  // namespace oktett
