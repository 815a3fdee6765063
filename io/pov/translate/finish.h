#pragma once
/// \file Finishes. Within io/ only.

#include <optional>

#include "io/pov/translate/context.h"

namespace oktett::pov {

/// What blocks `finish` say.
struct Finish {
  Vec3d ambient{0.1, 0.1, 0.1}, emission{0, 0, 0};
  double diffuse = 0.6, phong = 0, phong_size = 40, specular = 0, roughness = 0.05, metallic = 0;
  double brilliance = 1, crand = 0, diffuse_back = 0;
  double irid = 0, film_thickness = 0, film_turbulence = 0;
  Vec3d reflection{0, 0, 0}, reflection_max{0, 0, 0};
  /// Of the reflection: it grows from the one to the other.
  bool varies = false, fresnel = false;
  double falloff = 1, reflection_metallic = 0;
  bool conserves = false;
  std::optional<double> ior;  ///< as in old scenes
};

/// Reads a finish on top of what is known of it.
void read_finish(Context& context, const Block& block, Finish& finish);

}  // namespace oktett::pov
