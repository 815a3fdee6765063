#pragma once
/// \file What describes the surface of a polynomial in x, y and z.

#include <cstdint>
#include <vector>

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
};

}  // namespace oktett
