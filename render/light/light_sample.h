#pragma once
/// \file What light sampling is asked for, and what it answers.
///
/// Units: radiance in W / (m^2 sr), intensity in W / sr, irradiance in W / m^2, each per colour channel.

#include <cstdint>

#include "core/mesh.h"
#include "core/vec3.h"

namespace oktett {

/// In the place of the number of a list of points that some lights are for: they light all points.
inline constexpr std::uint8_t kNoLightList = 0xff;

/// A point that is lit.
struct LightPoint {
  Vec3f position;
  /// Unit vector; zero for a point in a medium, which light reaches from all sides.
  Vec3f normal;
  /// Light from behind the normal does not matter: the surface is opaque. Such light may still be sampled.
  bool front_only = false;
  /// Bit i: light of list i, see LightSet, reaches the point.
  std::uint16_t lists = 0xffff;
  /// The emitter of the LightSet whose surface the point is on; kNoId: none. The position is rounded, so it
  /// does not tell on which side of that surface the point is.
  std::uint32_t on = kNoId;
};

/// Light that may reach a point from one direction, if nothing is in between.
struct LightSample {
  Vec3f direction;  ///< unit vector from the point towards the light
  float distance;   ///< from the point to the light; infinity if the light is infinitely far away
  /// Radiance that arrives; for a delta light its irradiance on a surface that faces it.
  Color radiance;
  /// Density of choosing `direction`, per solid angle, times the probability of choosing the emitter; for a
  /// delta light that probability alone. Always > 0 and finite.
  float pdf;
  bool delta;             ///< the light is seen as a point, so no other ray can meet it
  std::uint32_t emitter;  ///< index into the emitters of the LightSet
  /// Where on the emitter the light comes from, for textures. Triangle: weights of the second and the third
  /// corner. Rectangle: fractions of its edges. Environment: fractions of width and height of the map.
  /// Others: 0.
  float u, v;
};

}  // namespace oktett
