#pragma once
/// \file What describes a Dupin cyclide.

#include "core/description.h"

namespace oktett {

/// (x^2 + y^2 + z^2 + b^2 - minor^2)^2 = 4 (major x - taper minor)^2 + 4 b^2 y^2 with b^2 = major^2 - taper^2
/// (Dupin 1822). Inside, the left side is less. For minor > major and for minor < taper the surface meets
/// itself; what two sheets enclose is outside.
struct CyclideShape {
  double major = 0.6, minor = 0.25, taper = 0.15;

  static constexpr ShapeInfo kShapeInfo{
      "cyclide", "Dupin's cyclide around the z axis: a torus whose tube is thinner at +x and thicker at -x"};
  void describe(auto& p) {
    p.field("major", major, kLength, "half the distance of the middles of the tube at +x and -x");
    p.field("minor", minor, kLength, "mean of the radii of the tube at +x and -x");
    p.field("taper", taper, kLength, "how much the tube is thinner at +x and thicker at -x than `minor`");
    p.normals();
    p.check(taper < major || major == 0, "taper", "the taper must be less than the major radius");
    p.nothing_if(major == 0, "the major radius is zero");
    p.nothing_if(minor == 0 && taper == 0, "the tube has no thickness");
  }
};

}  // namespace oktett
