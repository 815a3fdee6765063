#include "kernels/roots/methods.h"

#include <cmath>

namespace oktett::roots {

/// The root of p in (lo, hi), given the signs just inside the ends.
static Root refine_bisection(const Polynomial& p, double lo, double hi, int sign_lo) {
  for (;;) {
    const double m = lo + 0.5 * (hi - lo);
    if (!(m > lo && m < hi)) break;
    const double v = horner(p, m);
    if (v == 0) {
      lo = hi = m;
      break;
    }
    ((v > 0) == (sign_lo > 0) ? lo : hi) = m;
  }
  // Besides the last interval, the bound covers the points where the computed sign may be wrong.
  double slope;
  const Value v = evaluate(p, lo, slope);
  const double error = (hi - lo) + 0x1p-52 * std::abs(lo) + 2 * v.error / std::abs(slope);
  return {lo, std::isfinite(error) ? error : 0x1p-26, 1};
}

Roots solve_bisection(const Normalized& n) {
  Roots out;
  const int samples = 8 * n.p.degree;
  double l = n.a, left = horner(n.p, l);
  if (left == 0) out.add({l, 0x1p-53, 1});
  for (int i = 1; i <= samples; ++i) {
    const double r = i == samples ? n.b : n.a + (n.b - n.a) * (static_cast<double>(i) / samples);
    const double right = horner(n.p, r);
    if (right == 0) {
      if (r > l) out.add({r, 0x1p-53, 1});
    } else if ((left < 0 && right > 0) || (left > 0 && right < 0)) {
      out.add(refine_bisection(n.p, l, r, left < 0 ? -1 : 1));
    }
    l = r, left = right;
  }
  return out;
}

}  // namespace oktett::roots
