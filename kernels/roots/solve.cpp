#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "kernels/roots/closed_form.h"
#include "kernels/roots/methods.h"
#include "kernels/roots/roots.h"

namespace oktett::roots {

// ---- The change of variable before a method.

namespace {

/// e with 2^e <= |x| < 2^(e+1), for finite x != 0.
int exponent_of(double x) {
  const int biased = static_cast<int>(std::bit_cast<std::uint64_t>(x) >> 52) & 0x7ff;
  if (biased) return biased - 1023;
  const double up = x * 0x1p60;  // subnormal
  return (static_cast<int>(std::bit_cast<std::uint64_t>(up) >> 52) & 0x7ff) - 1083;
}

double power_of_two(int e) { return std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52); }

/// All roots are below 2^(the result) in absolute value: |x| < 2 max |c[n-k] / c[n]|^(1/k) (M. Fujiwara,
/// Tohoku Math. J. 10, 1916).
int root_exponent(const Polynomial& p) {
  const int top = exponent_of(p.c[p.degree]);
  int bound = -2200;
  for (int k = 1; k <= p.degree; ++k) {
    if (p.c[p.degree - k] == 0) continue;
    const int ratio = exponent_of(p.c[p.degree - k]) + 1 - top;
    bound = std::max(bound, ratio > 0 ? (ratio + k - 1) / k : -(-ratio / k));
  }
  return bound + 1;
}

}  // namespace

double scale_by_power(double y, int shift) {
  // Three steps cover every sum of two exponents of doubles; all but the last are exact.
  while (shift > 1000) y *= 0x1p1000, shift -= 1000;
  while (shift < -1000) y *= 0x1p-1000, shift += 1000;
  return y * power_of_two(shift);
}

Normalized normalize(const Polynomial& p, double a, double b) {
  Normalized out;
  out.zeros = 0;
  out.shift = 0;
  int high = p.degree, low = 0;
  if (high > kMaxDegree || a != a || b != b) return out.state = Normalized::bad_input, out;
  for (int i = 0; i <= high; ++i) {
    if (!std::isfinite(p.c[i])) return out.state = Normalized::bad_input, out;
  }
  while (high >= 0 && p.c[high] == 0) --high;
  if (a > b) return out.state = Normalized::empty_interval, out;
  if (high < 0) return out.state = Normalized::zero_polynomial, out;
  while (p.c[low] == 0) ++low;
  out.zeros = low;
  out.p.degree = high - low;
  if (high == low) return out.state = Normalized::no_root, out;
  for (int i = low; i <= high; ++i) out.p.c[i - low] = p.c[i];

  // 2^shift is at least the greater end, but not more than the roots need.
  const double reach = std::max(std::abs(a), std::abs(b));
  if (reach == 0) return out.state = Normalized::no_root, out;
  int shift = std::isfinite(reach) ? exponent_of(reach) : 1100;
  if (std::isfinite(reach) && reach != power_of_two(std::max(shift, -1022))) ++shift;
  int largest = -1 << 20;
  const auto find_largest = [&] {
    largest = -1 << 20;
    for (int i = 0; i <= out.p.degree; ++i) {
      if (out.p.c[i] != 0) largest = std::max(largest, exponent_of(out.p.c[i]) + i * shift);
    }
  };
  find_largest();
  if (exponent_of(out.p.c[out.p.degree]) + out.p.degree * shift == largest || shift > 1023) {
    const int bound = root_exponent(out.p);
    if (bound < shift) {
      shift = bound;
      find_largest();
    }
  }
  const auto clip = [&](double x) { return std::clamp(scale_by_power(x, -shift), -1.0, 1.0); };
  const double end = scale_by_power(1, std::min(shift, 1023));
  if (a > end || b < -end) return out.state = Normalized::no_root, out;
  out.a = std::isfinite(a) ? clip(a) : -1;
  out.b = std::isfinite(b) ? clip(b) : 1;
  out.shift = shift;
  for (int i = 0; i <= out.p.degree; ++i) {
    out.p.c[i] = scale_by_power(out.p.c[i], i * shift - largest - 1);
  }
  return out.state = Normalized::ready, out;
}

// ---- Closed forms.

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

// ---- The choice of the method.

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
