#include "accel/traverse/all_hits.h"

#include "accel/isa/trace_query.h"
#include "accel/traverse/inflight/all_hits_pairs.h"

namespace oktett {

template <class A>
void trace_all_hits(const Accel& accel, const RaySpan& rays, RayHitList& hits) {
  if constexpr (std::is_same_v<A, ScalarIsa>) {
    for (std::size_t i = 0; i < rays.size; ++i) {
      trace_all_hits<A>(accel, rays[i], hits.scratch());
      hits.take_scratch(i);
    }
  } else {
    AllHitsTraversal<A>(accel, rays, hits).run();
  }
}

template void trace_all_hits<OKTETT_ISA>(const Accel&, const Ray&, HitList&);
template void trace_all_hits<OKTETT_ISA>(const Accel&, const RaySpan&, RayHitList&);

}  // namespace oktett
