#include "accel/isa/trace_query.h"
#include "accel/trace_code.h"
#include "core/simd_native.h"

namespace oktett {

template <class A>
const TraceCode& trace_code() {
  static constexpr TraceCode code = {trace<Query::closest, A>, trace<Query::any, A>, trace_all_hits<A>};
  return code;
}

template const TraceCode& trace_code<OKTETT_ISA>();

}  // namespace oktett
