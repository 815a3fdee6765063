#pragma once
/// \file Newton's method within a bracket, with bounds on its result; and a root finder that applies it
/// between critical points.

#include "kernels/roots/normalize.h"

namespace oktett::roots {

/// The one root of p in (lo, hi), given that p has the sign `sign_lo` just above lo and the opposite just
/// below hi. `start` is a first guess. The signs of p at its ends prove the bound; if they are unsure, the
/// bound is the bracket itself. Within [-1, 1], see polynomial.h.
Root refine_newton(const Polynomial& p, double lo, double hi, int sign_lo, double start);

/// The tightest interval x +- error that contains the root described at refine_newton, given x near it and a
/// guess of the error.
Root enclose(const Polynomial& p, double x, double error, double lo, double hi, int sign_lo);

/// Roots between critical points, which are the roots of the derivative, and so on down to degree 1 (C.
/// Yuksel: High-Performance Polynomial Root Finding for Graphics, Proc. ACM Comput. Graph. Interact. Tech.
/// 5(3), 2022). Departs from the paper in that critical points are found to full precision. Signs at critical
/// points are taken as computed: not certified.
Roots solve_newton(const Normalized& n);

}  // namespace oktett::roots
