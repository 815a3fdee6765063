#pragma once
/// \file What describes a sweep of spheres.

#include <cstdint>
#include <vector>

#include "core/description.h"
#include "core/vec3.h"

namespace oktett {

/// A sphere on the way of a sweep.
struct SweptSphere {
  Vec3d center;
  double radius;
};

/// Most spheres of a sweep in a scene file.
inline constexpr std::uint32_t kMaxSweptSpheres = 1 << 20;

/// What a sphere passes over as its centre and its radius go along a curve.
struct SphereSweepShape {
  /// What goes through the spheres, after POV-Ray's splines of the same names.
  enum class Curve : std::uint8_t {
    linear,    ///< straight from sphere to sphere: round cones
    cubic,     ///< a Catmull-Rom curve; the first and the last sphere are not met
    b_spline,  ///< uniform and cubic, near the spheres; from near the second to near the last but one
  };
  std::vector<SweptSphere> spheres;
  Curve curve = Curve::linear;

  static constexpr ShapeInfo kShapeInfo{"sphere_sweep", "what a sphere passes over as it moves and grows"};
  void describe(auto& p) {
    p.required("spheres", spheres, whole(2, kMaxSweptSpheres),
               "on the way, at least 4 unless it is `linear`");
    p.choice("curve", curve,
             {{"linear", Curve::linear}, {"cubic", Curve::cubic}, {"b_spline", Curve::b_spline}},
             "through centres and radii: `cubic` does not meet the first and the last one, `b_spline` passes "
             "near all");
    const auto count = static_cast<double>(spheres.size());
    p.check(curve == Curve::linear || count >= 4, "spheres", "expected at least 4 spheres", &count);
    p.normals();
  }
};

}  // namespace oktett
