#pragma once
/// \file How light fades with the distance from its place, and from the line in its middle.

#include "core/description.h"

namespace oktett {

/// Light that grows less with the distance r from the emitter by 2 / (1 + (r / distance)^power): twice the
/// light at the emitter, once at `distance`.
struct LightFade {
  double distance = 0;  ///< 0: it does not fade
  double power = 2;
  bool operator==(const LightFade&) const = default;
  bool fades() const { return distance > 0; }

  static constexpr const char* kMap = "a fade";
  void describe(auto& p) {
    p.required("distance", distance, kPositive, "where the light has its full strength");
    p.field("power", power, kPositive, "how fast it fades");
  }
};

/// Parallel light about a line: full up to the inner radius, dark from the outer one on, smooth between.
struct LightBeam {
  double outer_radius = 0;  ///< 0: it is as wide as the world
  double inner_radius = 0;  ///< [0, outer_radius]
  double tightness = 0;     ///< power of 1 - r / outer_radius that multiplies the light at the distance r
  bool operator==(const LightBeam&) const = default;
  bool ends() const { return outer_radius > 0; }

  static constexpr const char* kMap = "a beam";
  void describe(auto& p) {
    p.required("outer_radius", outer_radius, kPositive, "where light ends");
    p.field("inner_radius", inner_radius, kNonNegative, "where it begins to fade");
    p.check(inner_radius <= outer_radius, "inner_radius", "'inner_radius' is greater than 'outer_radius'");
    p.field("tightness", tightness, kNonNegative,
            "power of 1 - r / outer_radius that multiplies the light at the distance r from the line");
  }
};

}  // namespace oktett
