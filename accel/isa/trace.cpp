#include "accel/isa/trace_query.h"

namespace oktett {

template <class A>
const TraceCode& trace_code() {
  using Functions = TraceFunctions<A>;
  static constexpr TraceCode code = {Functions::closest_hit, Functions::any_hit, Functions::all_hits};
  return code;
}

template const TraceCode& trace_code<OKTETT_ISA>();

}  // namespace oktett
