#pragma once
/// \file The methods by which roots are found, and what they share: the change of variable before, refining
/// and counting roots.

#include "kernels/roots/polynomial.h"

namespace oktett::roots {

/// p(2^shift y) up to a power of two as factor, for y in [a, b] within [-1, 1]; p(0) != 0.
struct Normalized {
  /// Whether there is something left to solve (`ready`) or the answer is already known.
  enum State { ready, bad_input, empty_interval, zero_polynomial, no_root } state;
  Polynomial p;
  double a, b;
  int shift;
  /// Number of roots at exactly 0 that were divided out, whether or not the interval contains 0.
  int zeros;
};

/// An exact change of variable by powers of two, after which interval and coefficients are about 1. Then no
/// later step overflows, and underflow does not matter. Drops zero coefficients at both ends, bounds an
/// infinite or far too long interval by the size of the roots (Fujiwara's bound in powers of two) and scales.
/// `bad_input`: a coefficient is NaN or infinite, an end is NaN, or the degree is above kMaxDegree. For
/// `no_root`, `zeros` is valid.
Normalized normalize(const Polynomial& p, double a, double b);

/// y 2^shift, exactly unless it overflows or underflows.
double scale_by_power(double y, int shift);

/// Isolation of roots in the Bernstein basis, the certified method: the roots in [n.a, n.b], at most `wanted`
/// of them, from the least up.
///
/// On an interval, a polynomial has at most as many roots as its Bernstein coefficients have changes of sign,
/// and the difference is even (variation diminishing; J. M. Lane, R. F. Riesenfeld: Bounds on a Polynomial,
/// BIT 21, 1981; the real-root isolation of B. Mourrain, F. Rouillier, M.-F. Roy, 2005). Intervals are halved
/// until the count is 0 or 1. Departs from the papers in that every coefficient carries an error bound and
/// signs within it count as unknown. Pieces that cannot be decided in double are examined in double-double;
/// those that cannot be decided there are clusters.
Roots solve_bernstein(const Normalized& n, int wanted = kMaxDegree);

/// Closed forms, for degrees up to 4. The signs on both sides prove each root; the changes of sign of the
/// Bernstein coefficients prove that there are no others. Certified if both succeed; they fail only if roots,
/// or complex pairs near the interval, are close together.
Roots solve_closed(const Normalized& n);

/// Sturm chains (J. C. F. Sturm, Mémoire sur la résolution des équations numériques, 1829): isolates the
/// roots by halving until the chain counts one, then refines. The chain is computed in double-double with a
/// bound on the error of each coefficient, which tells the sure signs. Certified if all signs that were
/// needed are sure. Multiple roots end the chain early and are never certified.
Roots solve_sturm(const Normalized& n);

/// Laguerre's method with deflation: finds one complex root after another from 0, divides it out, and
/// polishes it against the whole polynomial. Stops when the value is below the error of its computation (D.
/// A. Adams: A stopping criterion for polynomial root finding, Comm. ACM 10(10), 1967). Roots with a small
/// imaginary part count as real. Bounds are estimates, so nothing is certified.
Roots solve_laguerre(const Normalized& n);

/// Samples the interval at 8 points per degree and bisects where the sign changes, until the ends are
/// neighbouring doubles or a zero is met: the simplest root finder. Two roots between samples are missed: not
/// certified.
Roots solve_bisection(const Normalized& n);

/// Roots between critical points, which are the roots of the derivative, and so on down to degree 1 (C.
/// Yuksel: High-Performance Polynomial Root Finding for Graphics, Proc. ACM Comput. Graph. Interact. Tech.
/// 5(3), 2022). Departs from the paper in that critical points are found to full precision. Signs at critical
/// points are taken as computed: not certified.
Roots solve_newton(const Normalized& n);

// What the methods share.

/// Bound on the number of roots in [a, b], counted with multiplicity; -1 <= a <= b <= 1, p(0) != 0.
int most_roots(const Polynomial& p, double a, double b);

/// The one root of p in (lo, hi), given that p has the sign `sign_lo` just above lo and the opposite just
/// below hi. `start` is a first guess. The signs of p at its ends prove the bound; if they are unsure, the
/// bound is the bracket itself. Within [-1, 1], see polynomial.h.
Root refine_newton(const Polynomial& p, double lo, double hi, int sign_lo, double start);

}  // namespace oktett::roots
