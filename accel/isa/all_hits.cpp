#include "accel/traverse/all_hits.h"

#include "accel/isa/trace_query.h"
#include "accel/traverse/inflight/all_hits_pairs.h"

namespace oktett {

template <class A>
void trace_all_hits(const Accel& accel, const Ray& ray, HitList& hits) {
  RayState<1, A> state;
  if (state.set(ray, accel.bounds) != 0) collect(accel, state, hits);
}

template <class A>
void trace_all_hits(const Accel& accel, const RaySpan& rays, RayHitList& hits) {
  if constexpr (std::is_same_v<A, ScalarIsa>) {
    HitList& found = hits.scratch();
    for (std::size_t i = 0; i < rays.size; ++i) {
      trace_all_hits<A>(accel, rays[i], found);
      for (std::size_t k = 0; k < found.size(); ++k) {
        const RayHit hit{found[k], static_cast<std::uint32_t>(i)};
        hits.append(&hit, 1);
      }
      found.shrink(0);
    }
  } else {
    AllHitsTraversal<A>(accel, rays, hits).run();
  }
}

template void trace_all_hits<OKTETT_ISA>(const Accel&, const Ray&, HitList&);
template void trace_all_hits<OKTETT_ISA>(const Accel&, const RaySpan&, RayHitList&);

}  // namespace oktett
