#pragma once
/// \file Sturm chains: how many roots lie in an interval.

#include "kernels/roots/normalize.h"

namespace oktett::roots {

/// Isolates the roots by halving until the chain counts one, then refines. The chain is computed in
/// double-double with a bound on the error of each coefficient, which tells the sure signs. Certified if all
/// signs that were needed are sure. Multiple roots end the chain early and are never certified.
///
/// J. C. F. Sturm, Mémoire sur la résolution des équations numériques, 1829.
Roots solve_sturm(const Normalized& n);

}  // namespace oktett::roots
