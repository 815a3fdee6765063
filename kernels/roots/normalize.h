#pragma once
/// \file An exact change of variable by powers of two, after which interval and coefficients are about 1.
/// Then no later step overflows, and underflow does not matter.

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

/// Drops zero coefficients at both ends, bounds an infinite or far too long interval by the size of the roots
/// (Fujiwara's bound in powers of two) and scales. `bad_input`: a coefficient is NaN or infinite, an end is
/// NaN, or the degree is above kMaxDegree. For `no_root`, `zeros` is valid.
Normalized normalize(const Polynomial& p, double a, double b);

/// y 2^shift, exactly unless it overflows or underflows.
double scale_by_power(double y, int shift);

}  // namespace oktett::roots
