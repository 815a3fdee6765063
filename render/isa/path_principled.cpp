#include "render/bsdf/principled_lobes.h"

#include "render/transport/path_shading.h"

namespace oktett {

template <class A>
void shade_principled_code(const InteractionBlock& found, const ArrivingRays& rays, const PathBlock& block,
                           const PrincipledSurface& surface, bool transmits, const PathRun& run,
                           PathQueues& out) {
  using Scattering = SurfaceScattering<PrincipledLobes, Simd<double, kDoubleLanes<A>, A>>;
  shade_path_run<Scattering>(found, rays, block, surface, transmits, run, out);
}

template void shade_principled_code<OKTETT_ISA>(const InteractionBlock&, const ArrivingRays&,
                                                const PathBlock&, const PrincipledSurface&, bool,
                                                const PathRun&, PathQueues&);

}  // namespace oktett
