/// \file Methods that iterate and certify nothing, and the refinement that the others share.

#include <algorithm>
#include <cmath>

#include "kernels/roots/methods.h"

namespace oktett::roots {

// ---- Laguerre's method.

namespace {

/// std::complex would call the C library for products and roots; this is plain arithmetic.
struct Complex {
  double re, im;
};
Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
Complex operator*(Complex a, Complex b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
Complex operator*(double s, Complex a) { return {s * a.re, s * a.im}; }
double norm(Complex a) { return std::sqrt(a.re * a.re + a.im * a.im); }
Complex operator/(Complex a, Complex b) {
  // Smith's method: no overflow if the quotient itself is in range.
  if (std::abs(b.re) >= std::abs(b.im)) {
    const double r = b.im / b.re, d = b.re + r * b.im;
    return {(a.re + r * a.im) / d, (a.im - r * a.re) / d};
  }
  const double r = b.re / b.im, d = b.im + r * b.re;
  return {(r * a.re + a.im) / d, (r * a.im - a.re) / d};
}
Complex square_root(Complex a) {
  const double m = norm(a);
  if (m == 0) return {0, 0};
  const double h = std::sqrt(0.5 * (m + std::abs(a.re))), k = 0.5 * a.im / h;
  if (a.re >= 0) return {h, k};
  return {std::abs(k), a.im < 0 ? -h : h};
}

struct ComplexPolynomial {
  int degree;
  Complex c[kMaxDegree + 1];
};

/// Laguerre steps from x until they no longer improve it.
Complex laguerre(const ComplexPolynomial& p, Complex x) {
  const int n = p.degree;
  for (int i = 1; i <= 80; ++i) {
    Complex value = p.c[n], d{0, 0}, half_second{0, 0};
    const double size = norm(x);
    double error = norm(value);
    for (int k = n - 1; k >= 0; --k) {
      half_second = half_second * x + d;
      d = d * x + value;
      value = value * x + p.c[k];
      error = error * size + norm(value);
    }
    if (norm(value) <= 0x1p-52 * error) return x;
    const Complex g = d / value, g2 = g * g, h = g2 - 2.0 * (half_second / value);
    const Complex root = square_root((n - 1.0) * (static_cast<double>(n) * h - g2));
    const Complex plus = g + root, minus = g - root;
    const Complex larger = norm(plus) >= norm(minus) ? plus : minus;
    const double m = norm(larger);
    // At a stationary point any direction will do.
    Complex step = m > 0 ? Complex{static_cast<double>(n), 0} / larger : Complex{0.1 * (1 + size), 0.07 * i};
    // Cycles are rare; an occasional shorter step breaks them.
    if (i % 10 == 0) step = (0.1 * (i / 10)) * step;
    const Complex next = x - step;
    if (next.re == x.re && next.im == x.im) return x;
    if (!(norm(next) < 1e100)) return x;
    x = next;
  }
  return x;
}

}  // namespace

Roots solve_laguerre(const Normalized& n) {
  ComplexPolynomial all, left;
  all.degree = n.p.degree;
  for (int i = 0; i <= n.p.degree; ++i) all.c[i] = {n.p.c[i], 0};
  left = all;
  Roots out;
  while (left.degree > 0) {
    Complex x = laguerre(left, {0, 0});
    Complex carry = left.c[left.degree];
    for (int i = left.degree - 1; i >= 0; --i) {
      const Complex next = left.c[i] + carry * x;
      left.c[i] = carry;
      carry = next;
    }
    --left.degree;
    x = laguerre(all, x);
    // The neighbourhood in which a root may be moved off the axis by rounding.
    if (!(std::abs(x.im) <= 0x1p-24 * (std::abs(x.re) + 0x1p-10))) continue;
    double slope;
    const Value v = evaluate(n.p, std::clamp(x.re, -1.0, 1.0), slope);
    const double error = n.p.degree * (std::abs(v.value) + v.error) / std::abs(slope) + 0x1p-52;
    if (!(x.re >= n.a && x.re <= n.b)) continue;
    out.add({x.re, std::isfinite(error) ? std::min(error, 0x1p-10) : 0x1p-10, 1});
  }
  std::sort(out.root, out.root + out.count, [](const Root& a, const Root& b) { return a.x < b.x; });
  return out;
}

// ---- Newton steps and bisection.

namespace {

/// Newton steps from `y` in (l, r), which shrinks; bisection where they do not converge. Ends when the step
/// is below the resolution or the sign is in doubt. Returns the last value and slope.
struct Iterate {
  double y;
  Value value;
  double slope;
};
Iterate newton_steps(const Polynomial& p, double y, double& l, double& r, int sign_lo) {
  Iterate at{y, {}, 0};
  double last = r - l;
  for (int i = 0; i < 100; ++i) {
    at.value = evaluate(p, at.y, at.slope);
    const double v = at.value.value;
    if (!(std::abs(v) > at.value.error)) break;
    ((v > 0) == (sign_lo > 0) ? l : r) = at.y;
    double step = v / at.slope, next = at.y - step;
    if (!(next > l && next < r && 2 * std::abs(step) <= last)) {
      next = l + 0.5 * (r - l);
      step = r - l;
    }
    last = std::abs(step);
    if (next <= l || next >= r || std::abs(next - at.y) <= 0x1p-52 * std::abs(at.y)) break;
    at.y = next;
  }
  return at;
}

/// Bounds above this fraction of the interval's greater end are improved in double-double arithmetic.
constexpr double kFineEnough = 0x1p-40;

double ulp(double x) { return 0x1p-52 * std::abs(x) + 0x1p-1000; }

/// The tightest interval x +- error that contains the root described at refine_newton, given x near it and a
/// guess of the error.
Root enclose(const Polynomial& p, double x, double error, double lo, double hi, int sign_lo) {
  for (error = std::max(error, ulp(x));; error *= 4) {
    const double l = x - error, r = x + error;
    const bool left = l <= lo || sign_at(p, l) == sign_lo, right = r >= hi || sign_at(p, r) == -sign_lo;
    if (left && right) {
      const double e = std::max(x - std::max(l, lo), std::min(r, hi) - x);
      return {x, e * (1 + 0x1p-50), 1};
    }
  }
}

/// Continues where the sign was in doubt in double. The slope in double is accurate enough for the steps.
OKTETT_NOINLINE Root refine_accurately(const Polynomial& p, Iterate at, double l, double r, int sign_lo) {
  double step = r - l;
  for (int i = 0; i < 60; ++i) {
    at.value = evaluate_accurately(p, at.y);
    const double v = at.value.value;
    if (!(std::abs(v) > at.value.error)) {
      step = 2 * at.value.error / std::abs(at.slope);
      break;
    }
    ((v > 0) == (sign_lo > 0) ? l : r) = at.y;
    if (i) evaluate(p, at.y, at.slope);
    double next = at.y - v / at.slope;
    if (i % 4 == 3 || !(next > l && next < r)) next = l + 0.5 * (r - l);
    step = std::abs(next - at.y);
    if (next <= l || next >= r) break;
    at.y = next;
    if (step <= 0x1p-36 * std::abs(next)) {
      step *= 0x1p-12;
      break;
    }
  }
  if (!(step <= r - l)) step = r - l;
  return enclose(p, at.y, step, l, r, sign_lo);
}

}  // namespace

Root refine_newton(const Polynomial& p, double lo, double hi, int sign_lo, double start) {
  double l = lo, r = hi;
  if (!(start > lo && start < hi)) start = lo + 0.5 * (hi - lo);
  Iterate at = newton_steps(p, start, l, r, sign_lo);
  double error = 2 * (std::abs(at.value.value) + at.value.error) / std::abs(at.slope);
  if (OKTETT_UNLIKELY(!(error <= kFineEnough * std::max(std::abs(lo), std::abs(hi))))) {
    return refine_accurately(p, at, l, r, sign_lo);
  }
  if (!(error <= r - l)) error = r - l;
  return enclose(p, at.y, error, l, r, sign_lo);
}

Roots solve_newton(const Normalized& n) {
  // Derivatives of p, then their roots from the lowest degree up: the roots of each are the critical points
  // of the next.
  Polynomial d[kMaxDegree];
  const int degree = n.p.degree;
  d[degree - 1] = n.p;
  for (int k = degree - 2; k >= 0; --k) d[k] = derivative(d[k + 1]);
  double critical[kMaxDegree + 2] = {n.a, n.b};
  int count = 2;
  Roots out;
  for (int k = 0; k < degree; ++k) {
    const bool last = k == degree - 1;
    double next[kMaxDegree + 2];
    int found = 0;
    next[found++] = n.a;
    double left = horner(d[k], critical[0]);
    for (int i = 0; i + 1 < count; ++i) {
      const double right = horner(d[k], critical[i + 1]);
      if (left == 0 && i == 0 && last) out.add({critical[0], ulp(critical[0]), 1});
      if (right == 0 && last) out.add({critical[i + 1], ulp(critical[i + 1]), 1});
      if ((left < 0 && right > 0) || (left > 0 && right < 0)) {
        const double lo = critical[i], hi = critical[i + 1], start = lo + (hi - lo) * (left / (left - right));
        if (last) {
          out.add(refine_newton(d[k], lo, hi, left < 0 ? -1 : 1, start));
        } else {
          double l = lo, r = hi;
          next[found++] = newton_steps(d[k], start > lo && start < hi ? start : lo + 0.5 * (hi - lo), l, r,
                                       left < 0 ? -1 : 1)
                              .y;
        }
      }
      left = right;
    }
    next[found++] = n.b;
    count = found;
    std::copy(next, next + found, critical);
  }
  return out;
}

}  // namespace oktett::roots
