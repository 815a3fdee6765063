#pragma once
/// \file Closed forms whose roots are certified afterwards.

#include "kernels/roots/normalize.h"

namespace oktett::roots {

/// For degrees up to 4. The signs on both sides prove each root; the changes of sign of the Bernstein
/// coefficients prove that there are no others. Certified if both succeed; they fail only if roots, or
/// complex pairs near the interval, are close together.
Roots solve_closed(const Normalized& n);

}  // namespace oktett::roots
