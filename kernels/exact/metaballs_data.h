#pragma once
/// \file What describes metaballs.

#include <vector>

#include "core/vec3.h"

namespace oktett {

/// strength (1 - a^2 / radius^2)^2 at the distance a < radius from the centre, 0 beyond.
struct MetaBall {
  Vec3d center{0, 0, 0};
  double radius = 1;    ///< > 0
  double strength = 1;  ///< of either sign
};

/// The sum of the balls' potentials is `iso` on the surface and greater inside (M. Melcher: Blobs II).
struct MetaballsShape {
  double iso = 0.5;  ///< > 0
  std::vector<MetaBall> balls;
};

}  // namespace oktett
