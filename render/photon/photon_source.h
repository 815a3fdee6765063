#pragma once
/// \file Photons as they leave the lights of a scene.

#include <cstdint>
#include <optional>
#include <vector>

#include "core/box.h"
#include "core/ray.h"
#include "render/geometry.h"
#include "render/scene_lights.h"

namespace oktett {

// ---- Which surfaces make caustics, and where they are.

/// Whether path tracing may send light from the material in ideal mirror or refracted directions.
bool may_cast(const Material& material);

/// The surfaces that may send light on in ideal directions.
struct Casters {
  Box bounds;              ///< of those that have bounds; empty if there are none
  bool unbounded = false;  ///< some have none

  bool none() const { return bounds.empty() && !unbounded; }
};

/// Geometries count as a whole: an instance that shows one mirror has the bounds of all that it shows.
Casters find_casters(const World& world);

// ---- Photons of lights.

/// The start of a photon: a ray of unit direction.
struct PhotonStart {
  Ray ray;
  /// In W per colour channel: the mean over many photons is the power of all lights that goes to the target.
  Color power;
  std::uint32_t emitter = 0;  ///< of the LightSet
  bool distant = false;       ///< comes from infinitely far away; the ray starts outside the scene's bounds
};

/// Sends photons of all lights towards one ball.
class PhotonSource {
 public:
  /// The ball to which photons are sent. Light that starts inside goes in all directions.
  struct Target {
    Vec3d center;
    double radius = 0;
  };

  /// Photons go to the bounds of `casters`; in all directions if these have none. `lights` and
  /// `textures` must outlive the source.
  PhotonSource(const World& world, const SceneLights& lights, const TextureSampler* textures,
               const Casters& casters);

  /// Whether there is no light to send.
  bool empty() const { return sums_.empty() || !(sums_.back() > 0); }
  /// Whether the photons carry the light of this emitter of the LightSet: not if it has no power, or if it is
  /// a point without falloff, whose power would be infinite.
  bool brings(std::uint32_t emitter) const { return brings_[emitter] != 0; }
  /// Whether the photons carry the light of all emitters that are infinitely far away. Not if mirrors or
  /// glass without bounds would need infinitely many photons.
  bool brings_distant() const { return brings_distant_; }
  std::uint32_t emitter_count() const { return static_cast<std::uint32_t>(brings_.size()); }
  /// 0 if photons go in all directions.
  double target_radius() const { return target_ ? target_->radius : 0; }

  /// The photon that these numbers in [0, 1) choose. Nothing if it carries no light.
  std::optional<PhotonStart> emit(double choice, const SquareSample& place,
                                  const SquareSample& direction) const;

 private:
  const SceneLights& lights_;
  const TextureSampler* textures_;
  std::optional<Target> target_;
  double far_ = 0;            ///< from the target's centre to a place outside the scene's bounds
  std::vector<double> sums_;  ///< per emitter: the weights of this one and those before it
  std::vector<std::uint8_t> brings_;
  bool brings_distant_ = false;
};

}  // namespace oktett
