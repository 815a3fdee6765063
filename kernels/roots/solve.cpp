#include "kernels/roots/solve.h"

#include <algorithm>
#include <cmath>

#include "kernels/roots/methods.h"

namespace oktett::roots {
namespace {

Roots run(const Normalized& n, Method method, int wanted) {
  switch (method) {
    case Method::closed:
      return n.p.degree <= 4 ? solve_closed(n) : solve_bernstein(n, wanted);
    case Method::sturm:
      return solve_sturm(n);
    case Method::laguerre:
      return solve_laguerre(n);
    case Method::bisection:
      return solve_bisection(n);
    case Method::newton:
      return solve_newton(n);
    case Method::bernstein:
      return solve_bernstein(n, wanted);
    case Method::automatic:
      break;
  }
  if (n.p.degree <= 2) {
    const Roots closed = solve_closed(n);
    if (closed.certified) return closed;
  }
  return solve_bernstein(n, wanted);
}

/// A root in [-1, 1] as one of the problem before it was scaled, moved into [a, b].
Root restore(Root r, int shift, double a, double b) {
  r.x = scale_by_power(r.x, shift);
  // Adds the least subnormal, which covers the rounding of subnormals.
  r.error = scale_by_power(r.error, shift) + (shift < -900 ? 0x1p-1074 : 0);
  const double inside = std::clamp(r.x, a, b);
  if (inside != r.x) r.error = (r.error + std::abs(inside - r.x)) * (1 + 0x1p-50), r.x = inside;
  return r;
}

}  // namespace

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

const char* to_string(Method method) {
  constexpr const char* kNames[] = {"auto",     "closed",    "bernstein", "sturm",
                                    "laguerre", "bisection", "newton"};
  return kNames[static_cast<int>(method)];
}

Roots solve(const Polynomial& p, double a, double b, Method method, int wanted) {
  const Normalized n = normalize(p, a, b);
  Roots out;
  if (n.state != Normalized::ready && n.state != Normalized::no_root) {
    out.certified = n.state != Normalized::bad_input;
    out.everywhere = n.state == Normalized::zero_polynomial;
    return out;
  }
  out.certified = true;
  if (n.state == Normalized::ready) {
    out = run(n, method, wanted);
    for (int i = 0; i < out.count; ++i) out.root[i] = restore(out.root[i], n.shift, a, b);
  }
  if (n.zeros && a <= 0 && b >= 0) {
    out.add({0, 0, n.zeros});
    for (int i = out.count - 1; i > 0 && out.root[i].x < out.root[i - 1].x; --i) {
      std::swap(out.root[i], out.root[i - 1]);
    }
  }
  out.count = std::min(out.count, wanted);
  return out;
}

}  // namespace oktett::roots
