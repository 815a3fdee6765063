#pragma once
/// \file The random numbers of photons.

#include "core/random.h"
#include "render/medium/medium_tracker.h"
#include "render/sampling/owen_sobol.h"

namespace oktett {

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
  static constexpr std::uint32_t kInMedia = 1u << 20;

  static std::uint32_t dimension(PhotonDecision decision, unsigned level) {
    constexpr auto per_level = static_cast<std::uint32_t>(PhotonDecision::count) - 3;
    return static_cast<std::uint32_t>(decision) + level * per_level;
  }

  std::uint64_t key_;
};

}  // namespace oktett
