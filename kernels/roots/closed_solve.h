#pragma once
/// \file Closed forms with a certificate after the fact.

#include "kernels/roots/normalize.h"

namespace oktett::roots {

/// For degrees up to 4. Each root is proved by the signs beside it; that there are no others, by the changes
/// of sign of the Bernstein coefficients. Certified if both succeed, which they do unless roots, or complex
/// pairs near the interval, are close together.
Roots solve_closed(const Normalized& n);

}  // namespace oktett::roots
