#pragma once
/// \file Fog as Whitted's model has it: it veils what a ray meets by the way that the ray goes through it,
/// and takes light from the lamps that say so. That of POV-Ray (its user documentation, 3.7, "Fog").

#include <span>

#include "core/description.h"
#include "core/vec3.h"
#include "render/warp.h"

namespace oktett {

/// Fog outside of solids that are not hollow: everywhere, or by the height over a plane.
struct Fog {
  double distance = 1;   ///< on a way of this length through its full density 1/e of the light is left
  Color color{0, 0, 0};  ///< what is seen where nothing is left
  double filter = 0;     ///< [0, 1]: how far light that is left has been multiplied by the colour
  double transmit = 0;   ///< [0, 1]: the least part of light that is left on any way
  double altitude = 0;   ///< 0: fog is everywhere; else where its density has fallen to a half
  double offset = 0;     ///< the height along `up` below which the density is full
  Vec3d up{0, 1, 0};     ///< of any length but zero
  /// How much smaller than a unit the swaths of `clouds` are along each axis; zeros: it has none.
  Vec3d turbulence{0, 0, 0};
  /// A way's fog is thinner by this part times min(1, clouds in its middle) times e^(-length / distance).
  double turbulence_depth = 0.5;
  PatternTurbulence clouds{};  ///< without its amount
  bool operator==(const Fog&) const = default;

  static constexpr const char* kMap = "a fog";
  void describe(auto& p) {
    p.required("distance", distance, kPositiveLength, "the way on which 1/e of the light is left");
    p.required("color", color, "what is seen where nothing is left");
    p.field("filter", filter, kUnitInterval, "how far light that is left has the colour");
    p.field("transmit", transmit, kUnitInterval, "the least part of light that is left");
    p.optional("altitude", altitude, kPositiveLength,
               "fog on the ground: height over `offset` at which it has half of its density; everywhere if "
               "left out");
    p.field("offset", offset, kCoordinate,
            "height along `up` below which a fog on the ground is as dense as can be");
    p.field("up", up, kCoordinate, "of any length but zero");
    p.check(length(up) > 0, "up", "the direction must not be zero");
    p.field("turbulence", turbulence, kCoordinate,
            "swaths: how many times smaller than a unit they are along each axis; zeros: none");
    p.field("turbulence_depth", turbulence_depth, kUnitInterval, "the most that they take from fog");
    clouds.describe(p);
    clouds.describe_generator(p);
  }
};

/// What becomes of light L on a way: L * left + light.
struct Veil {
  Color left{1, 1, 1}, light{0, 0, 0};
};

/// The way of length `distance`, which may be infinite, from `origin` in the unit direction `direction`.
/// Several fogs each add the light that they add alone, so that in dense ones it is more than that of any.
Veil pass_fogs(std::span<const Fog> fogs, const Vec3d& origin, const Vec3d& direction, double distance);

}  // namespace oktett
