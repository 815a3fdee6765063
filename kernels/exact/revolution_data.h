#pragma once
/// \file What describes a surface of revolution.

#include <cstdint>
#include <vector>

namespace oktett {

/// A point of a profile, which turns about the y axis.
struct ProfilePoint {
  double radius, height;
};

/// x^2 + z^2 < r(y)^2, where r is given piece by piece; the ends are closed by disks (Melcher, "Surface of
/// Revolution").
struct RevolutionShape {
  enum class Profile : std::uint8_t {
    spline,  ///< r is cubic between the inner points; the first and the last only give slopes
    linear,  ///< straight between all points
    sor,     ///< r^2 is cubic between the inner points, as POV-Ray's `sor`
  };
  std::vector<ProfilePoint> points;  ///< heights ascend; in `linear` two may be the same
  Profile profile = Profile::spline;
  bool open = false;  ///< without the disks
};

}  // namespace oktett
