#include "accel/isa/trace_query.h"
#include "accel/trace_code.h"
#include "core/simd_native.h"

namespace oktett {

template <class A>
const TraceCode& trace_code() {
  static constexpr TraceCode code = {
      trace_one<Query::closest, A>,
      [](const Accel& accel, const Ray& ray) { return trace_one<Query::any, A>(accel, ray).valid(); },
      trace<Query::closest, A>,
      trace<Query::any, A>,
      trace_all_hits<A>,
      trace_all_hits<A>};
  return code;
}

template const TraceCode& trace_code<OKTETT_ISA>();

}  // namespace oktett
