/// \file The tables of this layer's code by instruction set.

#include "accel/build/sah.h"
#include "accel/code.h"
#include "accel/time/time_tree.h"
#include "core/isa_select.h"

namespace oktett {

const TraceCode& trace_code(Isa isa) {
  return with_isa(isa, []<class A>() -> const TraceCode& { return trace_code<A>(); });
}

const PointCode& point_code(Isa isa) {
  return with_isa(isa, []<class A>() -> const PointCode& { return point_code<A>(); });
}

const BuildKernels& build_kernels(Isa isa) {
  return with_isa(isa, []<class A>() -> const BuildKernels& { return build_kernels<A>(); });
}

const InteractionCode& interaction_code(Isa isa) {
  return with_isa(isa, []<class A>() -> const InteractionCode& { return interaction_code<A>(); });
}

const TimeCode& time_code(Isa isa) {
  return with_isa(isa, []<class A>() -> const TimeCode& { return time_code<A>(); });
}

}  // namespace oktett
