#pragma once
/// \file What describes a superquadric.

#include <cstdint>

#include "core/vec3.h"

namespace oktett {

/// Superquadrics (slides). With `ratio` the powers |x|^p are replaced by Blanc and Schlick's pseudo-powers
/// g_p(x) = |x| / (p + (1 - p) |x|); nothing is inside beyond their poles, |x| >= p / (p - 1) for p > 1.
struct SuperquadricShape {
  enum class Form : std::uint8_t {
    ellipsoid,    ///< |x/a|^p + |y/b|^q + |z/c|^r = 1
    hyperboloid,  ///< |x/a|^p + |y/b|^q - |z/c|^r = 1, cut by a box
    toroid,       ///< |d - (|x/a|^m + |y/b|^n)^q|^r + |z/c|^p = e^2
  };
  Form form = Form::ellipsoid;
  bool ratio = false;
  Vec3d radii{1, 1, 1};                 ///< a, b, c > 0
  double p = 2, q = 2, r = 2;           ///< > 0
  double m = 2, n = 2, d = 1, e = 0.5;  ///< of the toroid; m, n, e > 0, d >= 0
  Vec3d lo{-2, -2, -2}, hi{2, 2, 2};    ///< the box of the hyperboloid, lo < hi
  bool open = false;                    ///< without the faces of the box
};

}  // namespace oktett
