#include "accel/traverse/all_hits.h"

#include "accel/isa/trace_query.h"

namespace oktett {

template <class A>
void trace_all_hits(const Accel& accel, const Ray& ray, HitList& hits) {
  using F = Simd<float, 1, A>;
  RayState<1, A> state;
  if (state.set(broadcast<F>(ray.origin), broadcast<F>(ray.direction), F(ray.tmin), F(ray.tmax),
                accel.bounds) != 0)
    collect(accel, state, hits);
}

template void trace_all_hits<OKTETT_ISA>(const Accel&, const Ray&, HitList&);

}  // namespace oktett
