#pragma once
/// \file Photons on their way from the lights to the surfaces where they are kept.

#include <span>
#include <vector>

#include "core/random.h"
#include "render/context.h"
#include "render/medium/medium_tracker.h"
#include "render/photon/photon_map.h"
#include "render/photon/photon_source.h"
#include "render/sampling/owen_sobol.h"

namespace oktett {

// ---- The random numbers of photons.

/// What is decided at random for a photon. Those after `direction` are decided anew at each surface.
enum class PhotonDecision : std::uint32_t {
  light,
  place,
  direction,
  hole,
  lobe,
  scattering,
  roulette,
  count
};

/// The random numbers of photons of one pass.
class PhotonChoices {
 public:
  // Pixels are numbered with 32 bits, so their keys are others.
  PhotonChoices(std::uint32_t seed, std::uint32_t pass)
      : key_(pixel_key(seed, (std::uint64_t{1} << 40) + pass)) {}

  SquareSample point(std::uint32_t photon, PhotonDecision decision, unsigned level = 0) const {
    return sobol_point(photon, sequence_key(key_, dimension(decision, level)));
  }
  float number(std::uint32_t photon, PhotonDecision decision, unsigned level) const {
    return sobol_number(photon, sequence_key(key_, dimension(decision, level)));
  }
  /// By which it keeps one colour channel at its surface number `level`.
  float channel(std::uint32_t photon, unsigned level) const {
    return sobol_number(photon, sequence_key(key_, kDispersion + level));
  }
  /// For what media take of a photon before its surface number `level`.
  TrackingNumbers in_media(std::uint32_t photon, unsigned level) const {
    return {sequence_key(key_, kInMedia + level), photon};
  }
  /// For what media take of a photon before it starts: its light comes from infinitely far away.
  TrackingNumbers before_start(std::uint32_t photon) const {
    return {sequence_key(key_, kInMedia - 1), photon};
  }

 private:
  /// Beyond the dimensions of all decisions.
  static constexpr std::uint32_t kInMedia = 1u << 20, kDispersion = 1u << 21;

  static std::uint32_t dimension(PhotonDecision decision, unsigned level) {
    constexpr auto per_level = static_cast<std::uint32_t>(PhotonDecision::count) - 3;
    return static_cast<std::uint32_t>(decision) + level * per_level;
  }

  std::uint64_t key_;
};

// ---- What solids and media do to photons: where these start in them, and how much light passes.

/// The solids that each photon starts in. Those of the first photon of an emitter are found by
/// dielectrics_at; for the others the surfaces between the two places are counted. Empty if the scene tracks
/// no solids.
std::vector<DielectricStack> start_dielectrics(const RenderContext& context,
                                               std::span<const PhotonStart> starts);

/// The part of the light that passes a segment inside of the solids given, see MediumTracker::transmittance.
Color passing_media(const RenderContext& context, const DielectricStack& around, const MediumSegment& segment,
                    TrackingNumbers numbers);

/// For each photon the part of its light that reaches its start: 1, but for photons from infinitely far away.
/// Surfaces without bounds may stand in their way, with holes or as boundaries of media, and so may a medium
/// that fills all space. `numbers[i]` are the random numbers of photon i; `around` is from start_dielectrics.
std::vector<Color> reaching_start(const RenderContext& context, std::span<const PhotonStart> starts,
                                  std::span<const DielectricStack> around,
                                  std::span<const TrackingNumbers> numbers);

// ---- Photons on their way.

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
