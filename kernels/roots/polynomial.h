#pragma once
/// \file Polynomials in one variable: values with error bounds, derivatives, changes of variable.
///
/// Bounds are running bounds (N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd edition 2002,
/// section 5.1). All functions assume coefficients of at most about 1 and |x| <= 1, as `normalize`
/// (methods.h) provides; then errors by underflow are below kUnderflow.

#include "core/double_double.h"
#include "core/platform.h"
#include "kernels/roots/roots.h"

namespace oktett::roots {

/// Bound on the error of a value by products that underflow, flushed to zero or not.
inline constexpr double kUnderflow = 0x1p-900;

/// A computed value and a bound on its error.
struct Value {
  double value, error;
};

/// p(x), by Horner's rule.
double horner(const Polynomial& p, double x);
/// p(x) with its error bound; also the derivative, without a bound.
Value evaluate(const Polynomial& p, double x, double& slope);
/// p(x) in double-double arithmetic with its error bound.
Value evaluate_accurately(const Polynomial& p, double x);
/// The sum of |c[i]| x^i for x >= 0, rounded up.
double absolute_sum(const Polynomial& p, double x);

/// The sign of p(x): -1 or 1 if it is certain, first in double, then in double-double; else 0.
int sign_at(const Polynomial& p, double x);

/// p'.
Polynomial derivative(const Polynomial& p);
/// p(-x), exactly.
Polynomial reflect(const Polynomial& p);

/// p(l + w x) in the Bernstein basis of degree p.degree: b[0] = p(l), b[degree] = p(l + w). T is double or
/// DoubleDouble. Returns a bound on the error of each coefficient, for w >= 0 rounded by one unit of T.
template <class T>
double to_bernstein(const Polynomial& p, const T& l, const T& w, T* b);

extern template double to_bernstein<double>(const Polynomial&, const double&, const double&, double*);
extern template double to_bernstein<DoubleDouble>(const Polynomial&, const DoubleDouble&, const DoubleDouble&,
                                                  DoubleDouble*);

}  // namespace oktett::roots
