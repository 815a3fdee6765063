#pragma once
/// \file Laguerre's method with deflation: all roots, complex ones too.

#include "kernels/roots/normalize.h"

namespace oktett::roots {

/// Finds one complex root after another from 0, divides it out, and polishes it against the whole polynomial.
/// Stops when the value is below the error of its computation (D. A. Adams: A stopping criterion for
/// polynomial root finding, Comm. ACM 10(10), 1967). Roots with a small imaginary part count as real. Bounds
/// are estimates, so nothing is certified.
Roots solve_laguerre(const Normalized& n);

}  // namespace oktett::roots
