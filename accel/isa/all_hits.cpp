#include "accel/traverse/all_hits.h"

#include "accel/isa/trace_query.h"

namespace oktett {

template <class A>
void trace_all_hits(const Accel& accel, const Ray& ray, HitList& hits) {
  RayState<1, A> state;
  if (state.set(ray, accel.bounds) != 0) collect(accel, state, hits);
}

template void trace_all_hits<OKTETT_ISA>(const Accel&, const Ray&, HitList&);

}  // namespace oktett
