#pragma once
/// \file Media in Whitted's model: what they take from a ray and add to it, in steps along its way.

#include <functional>

#include "render/context.h"
#include "render/fog.h"

namespace oktett {

/// A part of a ray, of unit direction. It may be endless.
struct MediumWay {
  Vec3d origin, direction;
  double length = 0;
};

/// The value of a phase function per solid angle, where light that travels along `light` is seen by a ray
/// along `viewer`; unit vectors.
double phase_of(const Medium& medium, const Vec3d& light, const Vec3d& viewer);

/// What a medium does to light that comes along a way. Where it scatters light of lamps, calls
/// scatter(place, part): `part` times the phase function and the light that arrives there is added.
using ScatterPlace = std::function<void(const Vec3d& place, const Color& part)>;
Veil march_medium(const RenderContext& context, const Medium& medium, const MediumWay& way,
                  const ScatterPlace& scatter);

/// The part of light that passes the inside of a solid of this material (into World::materials) to where it
/// leaves it.
Color passing_interior(const RenderContext& context, std::uint32_t material, const MediumWay& way);

}  // namespace oktett
