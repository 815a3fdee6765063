#pragma once
/// \file Newton's method kept inside a bracket, and bounds on what it finds; between critical points it makes
/// a root finder of its own.

#include "kernels/roots/normalize.h"

namespace oktett::roots {

/// The one root of p in (lo, hi), given that p has the sign `sign_lo` just above lo and the opposite just
/// below hi. `start` is a first guess. The bound is proved by the signs of p at its ends, or is the bracket
/// itself where these cannot be told. Within [-1, 1], see polynomial.h.
Root refine_newton(const Polynomial& p, double lo, double hi, int sign_lo, double start);

/// The tightest x +- error that contains the root which refine_newton speaks of, given x near it and a guess
/// of the error.
Root enclose(const Polynomial& p, double x, double error, double lo, double hi, int sign_lo);

/// Roots between critical points, which are the roots of the derivative, and so on down to degree 1 (C.
/// Yuksel: High-Performance Polynomial Root Finding for Graphics, Proc. ACM Comput. Graph. Interact. Tech.
/// 5(3), 2022). Departs from the paper in that critical points are found to full precision. Signs at critical
/// points are taken as computed: not certified.
Roots solve_newton(const Normalized& n);

}  // namespace oktett::roots
