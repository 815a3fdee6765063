#include "kernels/roots/methods.h"

#include <algorithm>
#include <cmath>

namespace oktett::roots {
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

}  // namespace oktett::roots
