#pragma once
/// \file What describes the surface of a polynomial in x, y and z.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/description.h"
#include "core/vec3.h"
#include "kernels/roots/root_method.h"

namespace oktett {

/// c x^i y^j z^k.
struct Monomial {
  std::uint8_t i, j, k;
  double c;
};

/// The sum of the terms is negative inside and zero on the surface. What is outside of the box is no part of
/// the solid.
struct PolynomialShape {
  std::vector<Monomial> terms;        ///< i + j + k <= roots::kMaxDegree, each only once
  Vec3d lo{-1, -1, -1}, hi{1, 1, 1};  ///< lo < hi
  bool open = false;                  ///< without the faces of the box
  roots::Method root_finder = roots::Method::automatic;

  static constexpr ShapeInfo kShapeInfo{"polynomial", "the zeros of a polynomial in x, y and z"};
  void describe(auto& p) {
    p.required("equation", terms, "below 0 inside");
    p.required("bounds", SolidBox{lo, hi}, "the box that cuts it, and whose faces close it");
    p.field("open", open, "without the faces of the box");
    describe_root_finder(p, root_finder);
    p.normals();
    p.nothing_if(
        std::none_of(terms.begin(), terms.end(), [](const Monomial& m) { return m.i + m.j + m.k > 0; }),
        "the equation does not depend on x, y or z");
  }
};

}  // namespace oktett
