#pragma once
/// \file Rainbows as Whitted's model has them: colours by the angle to a direction, over what a ray meets.

#include <span>
#include <vector>

#include "core/description.h"
#include "core/vec3.h"
#include "render/fog.h"

namespace oktett {

/// A colour of a rainbow.
struct RainbowColor {
  double at = 0;  ///< [0, 1]: 0 at its inner edge, 1 at the outer one
  Color color{0, 0, 0};
  double transmit = 0;  ///< [0, 1]: the least part of what is behind that is seen
  double filter = 0;    ///< [0, 1]: how far what is behind has been multiplied by the colour
  bool operator==(const RainbowColor&) const = default;

  static constexpr const char* kMap = "a colour of a rainbow";
  void describe(auto& p) {
    p.required("at", at, kUnitInterval, "0 at the inner edge, 1 at the outer one");
    p.required("color", color, "what is seen there");
    p.field("transmit", transmit, kUnitInterval, "the least part of what is behind that is seen");
    p.field("filter", filter, kUnitInterval, "how far what is behind has the colour");
  }
};

/// A bow about the direction in which light travels, outside of solids that are not hollow.
struct Rainbow {
  Vec3d direction{0, -1, 0};         ///< of any length but zero
  double angle = 41.5;               ///< degrees from it to the middle of the bow
  double width = 3;                  ///< degrees across
  double distance = 1;               ///< on a way of this length 1 - 1/e of the bow is seen
  Vec3d up{0, 1, 0};                 ///< of any length but zero: where the middle of its arc is
  double arc = 360;                  ///< degrees, about the middle, that are seen
  double falloff_arc = 360;          ///< degrees of them, about the middle, where it is seen in full
  std::vector<RainbowColor> colors;  ///< by ascending places, linear in between
  bool operator==(const Rainbow&) const = default;

  static constexpr const char* kMap = "a rainbow";
  void describe(auto& p) {
    constexpr Range kTurn{0, 360};
    p.field("direction", direction, kCoordinate, "in which light travels, of any length but zero");
    p.field("angle", angle, Range{0, 180}, "degrees from it to the middle of the bow");
    p.field("width", width, Range{0, 360, true}, "degrees across");
    p.required("distance", distance, kPositiveLength, "the way on which 1 - 1/e of the bow is seen");
    p.field("up", up, kCoordinate, "where the middle of its arc is, of any length but zero");
    p.field("arc", arc, kTurn, "degrees of the turn, about the middle of its arc, that are seen");
    p.field(
        "falloff_arc", falloff_arc, kTurn,
        "degrees of them that are seen in full; from there it fades to the ends of the arc, by the square");
    p.check(length(direction) > 0, "direction", "the direction must not be zero");
    p.check(length(up) > 0, "up", "the direction must not be zero");
  }
};

/// What becomes of light that travels against the unit vector `direction` on a way of length `distance`,
/// which may be infinite. A later bow lies before an earlier one.
Veil pass_rainbows(std::span<const Rainbow> rainbows, const Vec3d& direction, double distance);

}  // namespace oktett
