#pragma once
/// \file Photons on their way from the lights to the surfaces where they are kept.

#include "render/context.h"
#include "render/photon/photon_map.h"
#include "render/photon/photon_source.h"

namespace oktett {

/// What became of the power of photons, averaged over the colour channels. `emitted` is the sum of the other
/// members up to rounding, but for what Russian roulette adds or takes away, whose mean is 0.
struct PhotonEnergy {
  double emitted = 0;
  double stored = 0;    ///< ended at a surface that keeps photons, after mirrors or glass
  double absorbed = 0;  ///< ended at any other place of a surface, or on the way to where the photon starts
  double escaped = 0;   ///< left the scene
  double media = 0;     ///< absorbed or scattered by media
  double cut = 0;       ///< was still on its way after the last bounce

  PhotonEnergy& operator+=(const PhotonEnergy& other);
};

/// The photons of one pass.
struct TracedPhotons {
  Column<Photon> photons;  ///< by number, those of one number by bounces
  PhotonEnergy energy;
};

/// Emits and follows the photons of pass number `pass`. A photon goes on as long as the material sends it in
/// an ideal mirror or refracted direction, and is kept wherever a surface it meets on the way also scatters
/// light otherwise, except on the surface that it meets first. Solids and their priorities bend it as they
/// bend paths; media attenuate it by all that they absorb and scatter. The result depends on neither the
/// camera nor the number of threads.
TracedPhotons trace_photons(const RenderContext& context, const PhotonSource& source, const PhotonPlan& plan,
                            std::uint32_t pass);

}  // namespace oktett
