#pragma once
/// \file A profile on a lamp that points somewhere.

#include <memory>

#include "core/vec3.h"
#include "render/light/light_profile.h"

namespace oktett {

/// A profile and where its angles count from; without a profile the same in all directions.
struct AimedProfile {
  std::shared_ptr<const LightProfile> profile = nullptr;
  Vec3d down{0, -1, 0};  ///< unit; vertical angles count from here
  Vec3d zero{1, 0, 0};   ///< unit, perpendicular to `down`: horizontal angle 0

  /// The factor on the intensity in the unit vector `direction` away from the lamp.
  float operator()(const Vec3d& direction) const;
};

/// The profile aimed along `down`, not zero, and turned about that by `rotation` degrees. Horizontal angles
/// count from +x, counter-clockwise as seen from above, if `down` points down; else they are turned with it
/// by the shortest way.
AimedProfile aim(std::shared_ptr<const LightProfile> profile, const Vec3d& down, double rotation);

}  // namespace oktett
