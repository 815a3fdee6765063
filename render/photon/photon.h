#pragma once
/// \file A photon that has arrived at a surface, as it is kept in memory and in files.

#include <cstdint>

#include "core/vec3.h"

namespace oktett {

/// Light that reaches a surface after mirrors or glass alone, in 32 bytes.
struct Photon {
  Vec3f position;
  /// In W per colour channel, divided by the square of the index of refraction around the surface, as
  /// radiance is in render/bsdf/bsdf.h.
  Color power;
  std::uint32_t direction = 0;    ///< in which the light travels, see pack_direction
  std::uint16_t bounces = 0;      ///< at mirrors and glass, > 0
  std::uint16_t light_group = 0;  ///< number of the light's, see LightGroups
  bool operator==(const Photon&) const = default;
};
static_assert(sizeof(Photon) == 32);

/// A unit vector in 32 bits: 16 for each coordinate on an octahedron that is folded flat (Cigolle et al.
/// 2014, JCGT 3(2)). The angle to the vector is below 1e-4.
std::uint32_t pack_direction(const Vec3f& direction);
/// The unit vector that pack_direction made `packed` of, nearly. Any number gives a unit vector.
Vec3f unpack_direction(std::uint32_t packed);

}  // namespace oktett
