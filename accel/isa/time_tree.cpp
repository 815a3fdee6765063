#include "accel/time/time_tree.h"

#include "accel/time/traverse_time.h"

namespace oktett {

template <Query Q, class A>
static Hit trace_time(const TimeTree& tree, const Ray& ray, float time, const TimeCalls& calls) {
  return tree.keys > 1 ? TimeTraversal<Q, true, A>(tree, time, calls).run(ray)
                       : TimeTraversal<Q, false, A>(tree, time, calls).run(ray);
}

template <class A>
const TimeCode& time_code() {
  static constexpr TimeCode code = {trace_time<Query::closest, A>, trace_time<Query::any, A>};
  return code;
}

template const TimeCode& time_code<OKTETT_ISA>();

}  // namespace oktett
