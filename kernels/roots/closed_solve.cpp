#include "kernels/roots/methods.h"

#include <algorithm>
#include <cmath>

#include "kernels/roots/closed_form.h"

namespace oktett::roots {
namespace {

using Lane = Simd<double, 1, ScalarIsa>;

/// Finds an error such that p surely changes its sign between x - error and x + error; false if it cannot.
bool prove(const Polynomial& p, double x, Root& out) {
  double slope;
  const Value v = evaluate(p, x, slope);
  double error =
      std::min(2 * (std::abs(v.value) + v.error) / std::abs(slope), 0x1p-48) + 0x1p-52 * std::abs(x);
  out = {x, error, 1};
  for (; error < 0x1p-20; error *= 16) {
    const double l = x - error, r = x + error;
    out.error = std::max(x - l, r - x);
    if (sign_at(p, l) * sign_at(p, r) < 0) return true;
  }
  out.error = std::isfinite(error) ? std::min(error, 0x1p-20) : 0x1p-20;
  return false;
}

}  // namespace

Roots solve_closed(const Normalized& n) {
  const int degree = n.p.degree;
  Lane c[5], lanes[4];
  for (int i = 0; i <= degree; ++i) c[i] = Lane(n.p.c[i]);
  if (degree == 1) solve_linear(c, lanes);
  if (degree == 2) solve_quadratic(c, lanes);
  if (degree == 3) solve_cubic(c, lanes);
  if (degree == 4) solve_quartic(c, lanes);
  Roots out;
  bool proved = true;
  for (int i = 0; i < degree; ++i) {
    double x;
    lanes[i].store(&x);
    if (!(x > n.a - 0x1p-20 && x < n.b + 0x1p-20)) continue;
    Root root;
    const bool sure = prove(n.p, x, root);
    if (root.x + root.error < n.a || root.x - root.error > n.b) continue;
    if (!sure && !(root.x >= n.a && root.x <= n.b)) continue;
    // With an end of the interval or another root within the bounds, the count is not sure.
    proved &= sure && root.x - root.error > n.a && root.x + root.error < n.b;
    if (out.count) {
      const Root& last = out.root[out.count - 1];
      proved &= last.x + last.error < root.x - root.error;
    }
    out.add(root);
  }
  out.certified = proved && most_roots(n.p, n.a, n.b) == out.count;
  return out;
}

}  // namespace oktett::roots
