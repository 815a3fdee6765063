#pragma once
/// \file Cubics in v, -1 <= v <= 1, of which profiles consist.

#include <cmath>

namespace oktett {

/// Powers from the lowest up.
inline double cubic(const double (&c)[4], double v) { return ((c[3] * v + c[2]) * v + c[1]) * v + c[0]; }

/// Its Bernstein coefficients over -1 <= v <= 1.
inline void bezier_of(const double (&c)[4], double (&b)[4]) {
  b[0] = cubic(c, -1), b[3] = cubic(c, 1);
  b[1] = c[0] - c[1] / 3 - c[2] / 3 + c[3], b[2] = c[0] + c[1] / 3 - c[2] / 3 - c[3];
}

/// Calls f(v, value) at the ends of -1 <= v <= 1 and where the cubic is greatest or least between them.
template <class F>
void for_extremes(const double (&c)[4], F&& f) {
  f(-1.0, cubic(c, -1)), f(1.0, cubic(c, 1));
  const double a = 3 * c[3], b = c[2], d = b * b - a * c[1];
  if (!(d >= 0)) return;
  const double q = -(b + std::copysign(std::sqrt(d), b));
  for (const double v : {q / a, c[1] / q})
    if (v > -1 && v < 1) f(v, cubic(c, v));
}

}  // namespace oktett
