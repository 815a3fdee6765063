#pragma once
/// \file Isolation of roots in the Bernstein basis: the certified method.
///
/// On an interval, a polynomial has at most as many roots as its Bernstein coefficients have changes of sign,
/// and the difference is even (variation diminishing; J. M. Lane, R. F. Riesenfeld: Bounds on a Polynomial,
/// BIT 21, 1981; the real-root isolation of B. Mourrain, F. Rouillier, M.-F. Roy, 2005). Intervals are halved
/// until the count is 0 or 1. Departs from the papers in that every coefficient carries an error bound and
/// signs within it count as unknown. Pieces that cannot be decided in double are examined in double-double;
/// those that cannot be decided there are clusters.

#include "kernels/roots/normalize.h"

namespace oktett::roots {

/// The roots in [n.a, n.b], at most `wanted` of them, from the least up.
Roots solve_bernstein(const Normalized& n, int wanted = kMaxDegree);

/// Bound on the number of roots in [a, b], counted with multiplicity; -1 <= a <= b <= 1, p(0) != 0.
int most_roots(const Polynomial& p, double a, double b);

}  // namespace oktett::roots
