#pragma once
/// \file What describes a Julia set of numbers with four parts.

#include <cmath>
#include <cstdint>

#include "core/description.h"

namespace oktett {

/// Most iterations; more would be finer than a float can tell apart.
inline constexpr int kMaxJuliaIterations = 24;

/// The points q = x + y i + z j + slice k whose first `iterations` images under q -> q^2 + c, or q^3 + c,
/// stay in the ball of radius (1 + sqrt(1 + 4 |c|)) / 2, from outside of which none returns: for ever more of
/// them, the filled Julia set (A. Norton: Generation and Display of Geometric Fractals in 3-D, 1982). In the
/// hypercomplex numbers i^2 = j^2 = -1 and k^2 = 1, and all products commute: ij = k, jk = -i, ki = -j (C. M.
/// Davenport: A Commutative Hypercomplex Algebra with Associated Function Theory, 1996).
struct JuliaShape {
  enum class Algebra : std::uint8_t { quaternion, hypercomplex };
  static constexpr double kMostEscape = 1000;

  double c[4] = {-0.2, 0.8, 0, 0};  ///< |c| <= 2
  double slice = 0;
  std::uint32_t iterations = 10;
  Algebra algebra = Algebra::quaternion;
  std::uint32_t power = 2;
  double escape = 0;

  static constexpr ShapeInfo kShapeInfo{
      "julia", "a slice of the Julia set of q² + c or q³ + c in the quaternions or hypercomplex numbers"};
  void describe(auto& p) {
    p.field("c", c, "the quaternion that is added; \\|c\\| <= 2");
    const double size = std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2] + c[3] * c[3]);
    p.check(size <= 2, "c", "expected |c| of at most 2", &size);
    p.field("slice", slice, "the fourth coordinate of all points");
    p.field("iterations", iterations, whole(1, kMaxJuliaIterations), "how many images of a point stay near");
    p.choice("algebra", algebra,
             {{"quaternion", Algebra::quaternion}, {"hypercomplex", Algebra::hypercomplex}},
             "of the numbers; products of `hypercomplex` ones commute, and k² = 1");
    p.field("power", power, whole(2, 3), "of q");
    p.field(
        "escape", escape, Range{0, kMostEscape, false, false, Unit::length},
        "the radius within which they stay, if it is greater than that from outside of which none returns");
    p.normals();
  }
};

}  // namespace oktett
