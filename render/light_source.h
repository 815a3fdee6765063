#pragma once
/// \file Lights as Whitted's model asks for them: each lights a point from one direction.

#include "core/vec3.h"
#include "render/light/aimed_profile.h"

namespace oktett {

/// A light in the precision of shading.
struct LightSource {
  Vec3f place;  ///< position, or the unit vector towards a directional light
  Color color;
  bool directional = false;
  bool falloff = false;
  bool spot = false;
  bool glows = false;                  ///< a point of a glowing surface, whose light goes by Lambert's law
  Vec3f axis;                          ///< of a spot: unit vector along the middle of its cone; of a glowing
                                       ///< surface: the unit normal of its front
  float cos_inner = 1, cos_outer = 0;  ///< of a spot: cosines of the angles between which it fades
  float back = 0;  ///< of a glowing surface: the fraction of the front's light that the back gives, 0 or 1
  float lift = 0;  ///< of a glowing surface: shadow rays end this far above it
  AimedProfile profile = {};
};

}  // namespace oktett
