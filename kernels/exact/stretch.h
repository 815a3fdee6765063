#pragma once
/// \file How much an affine map lengthens vectors.

#include <cmath>

#include "core/transform.h"

namespace oktett {

/// A bound on the length of `map`.vector(v) over that of v: the root of the sum of the squared coefficients
/// (the Frobenius norm), which is at most sqrt(3) times the greatest quotient.
inline double stretch(const Affine& map) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3d row{map.m[i][0], map.m[i][1], map.m[i][2]};
    sum += dot(row, row);
  }
  return std::sqrt(sum);
}

}  // namespace oktett
