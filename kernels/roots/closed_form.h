#pragma once
/// \file Closed forms for degree 1 to 4, in lanes. D is a Simd of double; each lane holds its own polynomial
/// and gets the same bits as at width 1. Only + - * / and sqrt are used.
///
/// A missing root is kNoRoot, which sorts behind all others. Newton steps polish the roots, but nothing here
/// proves that their number is right: `solve` proves that afterwards. Coefficients should be about 1 (scale
/// first); a NaN gives no roots.

#include "core/simd.h"
#include "kernels/roots/roots.h"

namespace oktett::roots {

namespace closed {

template <class D>
OKTETT_INLINE D copy_sign(const D& size, const D& sign) {
  return select(sign < D(0.0), -size, size);
}

/// The rounding error of p = a b (Dekker). Unlike product_error, the same everywhere even where it overflows.
template <class D>
OKTETT_INLINE D rounding_error(const D& a, const D& b, const D& p) {
  const D ca = D(134217729.0) * a, cb = D(134217729.0) * b;
  const D ah = ca - (ca - a), bh = cb - (cb - b);
  const D al = a - ah, bl = b - bh;
  return al * bl - (((p - ah * bh) - al * bh) - ah * bl);
}

/// a b - c d, corrected by the rounding errors of the products (Kahan's method).
template <class D>
OKTETT_INLINE D difference_of_products(const D& a, const D& b, const D& c, const D& d) {
  const D p = a * b, q = c * d;
  return (p - q) + (rounding_error(a, b, p) - rounding_error(c, d, q));
}

template <class D>
OKTETT_INLINE void order(D& a, D& b) {
  const D low = min(b, a);
  b = max(a, b);
  a = low;
}

/// Approximate cube root of x >= 0, never far too small: x^(1/4 + 1/16 + 1/64 + 1/256) by square roots, then
/// one step of Halley's method.
template <class D>
OKTETT_INLINE D rough_cube_root(const D& x) {
  const D a = sqrt(sqrt(x)), b = sqrt(sqrt(a)), c = sqrt(sqrt(b)), d = sqrt(sqrt(c));
  const D y = a * b * c * d, y3 = y * y * y;
  const D better = y * (y3 + x + x) / (y3 + y3 + x);
  return select(x > D(0.0), better, D(0.0));
}

/// One Newton step on the polynomial of degree N, omitted in lanes where it would lead far away.
template <int N, class D>
OKTETT_INLINE D polish(const D* c, const D& x) {
  D y = c[N], d(0.0);
  for (int i = N - 1; i >= 0; --i) {
    d = d * x + y;
    y = y * x + c[i];
  }
  const D step = y / d;
  return select(abs(step) <= D(0.0625) * (abs(x) + D(0x1p-20)), x - step, x);
}

}  // namespace closed

/// c[0] + c[1] x = 0.
template <class D>
OKTETT_INLINE void solve_linear(const D* c, D* x) {
  const D r = -(c[0] / c[1]);
  x[0] = select(abs(r) < D(kNoRoot), r, D(kNoRoot));
}

/// c[0] + c[1] x + c[2] x^2 = 0, without cancellation: the root of greater size first, the other from the
/// product of both. The discriminant is that of the coefficients to about an ulp.
template <class D>
OKTETT_INLINE void solve_quadratic(const D* c, D* x) {
  const D discriminant = closed::difference_of_products(c[1], c[1], D(4.0) * c[2], c[0]);
  const D q = D(-0.5) * (c[1] + closed::copy_sign(sqrt(max(discriminant, D(0.0))), c[1]));
  const D a = q / c[2], b = select(q == D(0.0), a, c[0] / q);
  const auto real = discriminant >= D(0.0);
  x[0] = select(real & (abs(a) < D(kNoRoot)), a, D(kNoRoot));
  x[1] = select(real & (abs(b) < D(kNoRoot)), b, D(kNoRoot));
  closed::order(x[0], x[1]);
}

namespace closed {

/// x^3 + c[2] x^2 + c[1] x + c[0]: the root farthest from the inflection by Newton's method from beyond it,
/// where the steps cannot overshoot; the others from the quotient (after W. Kahan: To Solve a Real Cubic
/// Equation, 1986).
template <class D>
OKTETT_INLINE void solve_monic_cubic(const D* c, D* x) {
  const D inflection = c[2] * D(-1.0 / 3.0);
  const D p = c[1] + inflection * c[2] * D(2.0) + D(3.0) * inflection * inflection;
  const D q = ((inflection + c[2]) * inflection + c[1]) * inflection + c[0];
  const D size = abs(q);
  // s^3 + p s = |q|, s > 0. 1.3247... solves k^3 = k + 1; the rest covers the rough root.
  D s = D(1.34) * max(rough_cube_root(size), sqrt(max(-p, D(0.0))));
  auto moving = s > D(0.0);
  for (int i = 0; i < 24 && any(moving); ++i) {
    const D s2 = s * s, slope = D(3.0) * s2 + p;
    const D next = (D(2.0) * s * s2 + size) / slope;
    moving = moving & (slope > D(0.0));
    const auto on = moving & (abs(next - s) > D(0x1p-45) * s);
    s = select(moving, next, s);
    moving = on;
  }
  const D root = inflection + copy_sign(s, -q);
  // Divided from the end that does not cancel.
  const D forward_b = c[2] + root, forward_c = forward_b * root + c[1];
  const D backward_c = -(c[0] / root), backward_b = (backward_c - c[1]) / root;
  const auto large = abs(root * root * root) > abs(c[0]);
  const D rest[3] = {select(large, forward_c, backward_c), select(large, forward_b, backward_b), D(1.0)};
  solve_quadratic(rest, x + 1);
  x[0] = select(abs(root) < D(kNoRoot), root, D(kNoRoot));
}

template <class D>
OKTETT_INLINE void order(D* x, int n) {
  for (int k = n - 1; k > 0; --k) {
    for (int i = 0; i < k; ++i) order(x[i], x[i + 1]);
  }
}

/// Lanes in which the reversed polynomial, whose roots are the reciprocals, has the greater leading
/// coefficient. Returns the coefficients to use, divided by that one, so that a tiny or zero leading
/// coefficient does no harm.
template <int N, class D>
OKTETT_INLINE typename D::M monic(const D* c, D* out) {
  const auto reversed = abs(c[0]) > abs(c[N]);
  const D lead = select(reversed, c[0], c[N]);
  for (int i = 0; i < N; ++i) out[i] = select(reversed, c[N - i], c[i]) / lead;
  return reversed;
}

template <int N, class D>
OKTETT_INLINE void finish(const D* c, const typename D::M& reversed, D* x) {
  for (int i = 0; i < N; ++i) {
    const auto there = x[i] < D(kNoRoot);
    D r = select(reversed, D(1.0) / x[i], x[i]);
    for (int k = 0; k < 3; ++k) r = polish<N>(c, r);
    x[i] = select(there & (abs(r) < D(kNoRoot)), r, D(kNoRoot));
  }
  order(x, N);
}

}  // namespace closed

/// Degree 3; x has room for 3.
template <class D>
OKTETT_INLINE void solve_cubic(const D* c, D* x) {
  D monic[3];
  const auto reversed = closed::monic<3>(c, monic);
  closed::solve_monic_cubic(monic, x);
  closed::finish<3>(c, reversed, x);
}

/// Degree 4; x has room for 4. Two quadratic factors (Descartes) from the greatest root of the resolvent
/// cubic, which is not negative.
template <class D>
OKTETT_INLINE void solve_quartic(const D* c, D* x) {
  D m[4];
  const auto reversed = closed::monic<4>(c, m);
  // Depressed by y = x + m[3] / 4: y^4 + p y^2 + q y + r.
  const D h = D(0.25) * m[3], h2 = h * h;
  const D p = m[2] - D(6.0) * h2;
  const D q = m[1] - D(2.0) * h * m[2] + D(8.0) * h * h2;
  const D r = ((D(-3.0) * h2 + m[2]) * h - m[1]) * h + m[0];
  const D resolvent[3] = {-(q * q), closed::difference_of_products(p, p, D(4.0), r), p + p};
  D z[3];
  closed::solve_monic_cubic(resolvent, z);
  D greatest(0.0);
  for (int i = 0; i < 3; ++i) greatest = max(select(z[i] < D(kNoRoot), z[i], D(0.0)), greatest);
  const D w = sqrt(greatest), middle = D(0.5) * (p + greatest);
  // (y^2 + w y + middle - k) (y^2 - w y + middle + k); for small w, k from k^2 = middle^2 - r.
  const auto thick = greatest > D(0x1p-26) * abs(p);
  const D k = select(thick, D(0.5) * (q / w), closed::copy_sign(sqrt(max(middle * middle - r, D(0.0))), q));
  const D first[3] = {middle - k, w, D(1.0)}, second[3] = {middle + k, -w, D(1.0)};
  solve_quadratic(first, x);
  solve_quadratic(second, x + 2);
  for (int i = 0; i < 4; ++i) x[i] = x[i] - h;
  closed::finish<4>(c, reversed, x);
}

}  // namespace oktett::roots
