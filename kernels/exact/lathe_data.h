#pragma once
/// \file What describes a lathe: a surface of revolution whose profile is any curve.

#include <cstdint>
#include <vector>

#include "core/description.h"
#include "kernels/exact/revolution_data.h"

namespace oktett {

/// As RevolutionShape for any plane curve of cubic Bezier pieces, which need not ascend.
struct LatheShape {
  std::vector<ProfilePoint> points;  ///< 3 n + 1 control points; pieces share their ends
  bool open = false;                 ///< without the disks at the curve's ends

  static void surfaces(auto& v);
};

/// Most points of a profile in a scene file.
inline constexpr std::uint32_t kMaxProfilePoints = 1024;

/// What turns about the y axis in a scene file: a RevolutionShape or a LatheShape.
struct TurnedProfile {
  enum class Kind : std::uint8_t { spline, linear, sor, curve, bezier };
  std::vector<ProfilePoint> points;
  Kind kind = Kind::spline;
  bool open = false;

  void describe(auto& p) {
    p.choice(
        "profile", kind,
        {{"spline", Kind::spline},
         {"linear", Kind::linear},
         {"sor", Kind::sor},
         {"curve", Kind::curve},
         {"bezier", Kind::bezier}},
        "`spline`: the radius is cubic in the height; `sor`: the squared radius is; `curve`: through the "
        "points, also back and forth; `bezier`: 3 n + 1 control points");
    p.field("open", open, "without the disks at the ends");
    p.required(
        "points", points, whole(2, kMaxProfilePoints),
        "the profile, of 4 points at least unless it is `linear`. For `spline`, `sor` and `curve` the first "
        "and the last point only give the directions at the ends; for `spline`, `sor` and `linear` "
        "heights ascend");
    const auto count = static_cast<double>(points.size());
    static_assert(kMaxProfilePoints == 1024);
    p.check(kind == Kind::linear || count >= 4, "points", "expected 4 to 1024 points", &count);
    p.normals();
  }
};

void LatheShape::surfaces(auto& v) {
  v.surface({"revolution", "what a profile passes over as it turns about the y axis"}, TurnedProfile{});
}

}  // namespace oktett
