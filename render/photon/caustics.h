#pragma once
/// \file Caustics by progressive photon mapping (Hachisuka et al. 2008), with the radii of Knaus and Zwicker
/// (2011).
///
/// Photons bring the light that reaches a surface after mirrors and glass alone, wherever that surface
/// scatters light in other ways, too. Path tracing leaves out what they bring. A sample of a pixel asks the
/// photons of one pass; each pass has photons of its own and a smaller radius than the one before.

#include <memory>
#include <span>
#include <vector>

#include "render/path_surface.h"
#include "render/photon/photon_map.h"
#include "render/photon/photon_source.h"

namespace oktett {

/// Which passes the samples of a pixel ask, each the next one.
struct PassRange {
  /// Passes number `first`, first + step, ..., `count` of them.
  std::uint32_t first = 0, step = 1, count = 1;
  /// The samples that ask: of each `cycle`, `asking` from number `begin` on.
  std::uint32_t cycle = 1, begin = 0, asking = 1;
  /// Each pixel begins with a pass chosen at random, else with the first. In adaptive sampling the number of
  /// a pixel's samples follows from its neighbours' samples. If these asked the same passes as its own, that
  /// number would depend on its own light, and its mean would be biased.
  bool at_random = false;

  /// The pass for sample number `sample` of the pixel whose random numbers have `key`.
  std::uint32_t pass(std::uint64_t key, std::uint32_t sample) const;
};

/// The photons of a scene, or of one moment of it, and which lights they stand for.
class Caustics {
 public:
  Caustics(std::shared_ptr<const PhotonMap> map, const PassRange& passes, const PhotonSource& source);

  const std::shared_ptr<const PhotonMap>& map() const { return map_; }

  /// Light from photons that leaves `p` towards the camera, for a path that reached `p` after `bounces`
  /// bounces and belongs to sample number `sample` of the pixel whose random numbers have `key`. Adds the
  /// light of each light group to `of_group`, if that is not null.
  Color light(std::uint64_t key, std::uint32_t sample, unsigned bounces, const ShadingPoint& p,
              const SurfaceBsdf& bsdf, Color* of_group = nullptr) const;

  /// Whether the light of this emitter that passes mirrors or glass on its way to a surface is left to
  /// photons.
  bool brings(std::uint32_t emitter) const { return emitter < brings_.size() && brings_[emitter] != 0; }
  /// The same for lights that are infinitely far away.
  bool brings_distant() const { return brings_distant_; }

 private:
  std::shared_ptr<const PhotonMap> map_;
  PassRange passes_;
  std::vector<std::uint8_t> brings_;
  bool brings_distant_;
  std::uint32_t depth_;
};

/// What photons the settings ask for, in a scene of so many moments.
PhotonPlan photon_plan(const IntegratorSettings& settings, std::uint32_t moments = 1);

/// Where the photons of a map come from.
struct PhotonOptions {
  std::shared_ptr<const PhotonMap> given;  ///< used if it is for this scene; null: photons are traced
  bool all_passes = false;                 ///< trace also those that no sample of a pixel asks for
  std::uint32_t added_samples = 0;         ///< more samples of each pixel than the settings say
};

/// Traces the photons that the settings ask for, or takes those given. Throws Error if these are for another
/// scene or other settings. `moments`: the scene, or what it is at each moment while the shutter is open, no
/// more of these than passes; pass number p belongs to moment p modulo their number. The result has the
/// photons of each moment, all of one map.
std::vector<Caustics> make_caustics(std::span<const RenderContext> moments, const PhotonOptions& options);

}  // namespace oktett
