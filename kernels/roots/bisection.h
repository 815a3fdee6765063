#pragma once
/// \file Sampling and bisection: the simplest root finder.

#include "kernels/roots/normalize.h"

namespace oktett::roots {

/// The root of p in (lo, hi), given the signs just inside the ends: halves the interval until its ends are
/// neighbouring doubles or a zero is met.
Root refine_bisection(const Polynomial& p, double lo, double hi, int sign_lo);

/// Samples the interval at 8 points per degree and bisects where the sign changes. Two roots between samples
/// are missed: not certified.
Roots solve_bisection(const Normalized& n);

}  // namespace oktett::roots
