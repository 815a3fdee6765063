#include "render/bsdf/phong_lobes.h"

#include "render/transport/path_shading.h"

namespace oktett {

template <class A>
void shade_phong_code(const InteractionBlock& found, const ArrivingRays& rays, const PathBlock& block,
                      const PhongSurface& surface, bool transmits, const PathRun& run, PathQueues& out) {
  using Scattering = SurfaceScattering<PhongLobes, Simd<double, kDoubleLanes<A>, A>>;
  shade_path_run<Scattering>(found, rays, block, surface, transmits, run, out);
}

template void shade_phong_code<OKTETT_ISA>(const InteractionBlock&, const ArrivingRays&, const PathBlock&,
                                           const PhongSurface&, bool, const PathRun&, PathQueues&);

}  // namespace oktett
