#include "accel/isa/trace_batch.h"

namespace oktett {

template void trace<Query::closest, OKTETT_ISA>(const Accel&, const RaySpan&, const HitSink<Query::closest>&,
                                                TraceMode);

template Hit trace_one<Query::closest, OKTETT_ISA>(const Accel&, const Ray&);
template HitWithNormal trace_one_with_normal<OKTETT_ISA>(const Accel&, const Ray&);
template bool judge_one<Query::closest, OKTETT_ISA>(const Accel&, const Ray&, HitJudge&);

// Packets that other units call.
template void trace_packet<Query::closest, kChunkRays<OKTETT_ISA>, OKTETT_ISA>(
    const Accel&, RayState<kChunkRays<OKTETT_ISA>, OKTETT_ISA>&, unsigned);

template void table_leaf_packet<Query::closest, kBeamGroup, OKTETT_ISA>(const Accel&, const LeafEntry&,
                                                                        RayState<kBeamGroup, OKTETT_ISA>&,
                                                                        unsigned);

}  // namespace oktett
