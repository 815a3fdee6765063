#pragma once
/// \file What describes a quaternion Julia set.

#include <cmath>
#include <cstdint>

#include "core/description.h"

namespace oktett {

/// Most iterations; more would be finer than a float can tell apart.
inline constexpr int kMaxJuliaIterations = 24;

/// The points q = x + y i + z j + slice k whose first `iterations` images under q -> q^2 + c stay in the ball
/// of radius (1 + sqrt(1 + 4 |c|)) / 2, from outside of which none returns: for ever more of them, the filled
/// Julia set (A. Norton: Generation and Display of Geometric Fractals in 3-D, 1982).
struct JuliaShape {
  double c[4] = {-0.2, 0.8, 0, 0};  ///< |c| <= 2
  double slice = 0;
  std::uint32_t iterations = 10;

  static constexpr ShapeInfo kShapeInfo{"julia", "a slice of the Julia set of q² + c in the quaternions"};
  void describe(auto& p) {
    p.field("c", c, "the quaternion that is added; \\|c\\| <= 2");
    const double size = std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2] + c[3] * c[3]);
    p.check(size <= 2, "c", "expected |c| of at most 2", &size);
    p.field("slice", slice, "the fourth coordinate of all points");
    p.field("iterations", iterations, whole(1, kMaxJuliaIterations), "how many images of a point stay near");
    p.normals();
  }
};

}  // namespace oktett
