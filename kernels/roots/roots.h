#pragma once
/// \file Real roots of a polynomial in an interval: what goes in and what comes out. `solve` is the
/// entrance; docs/roots.md states what "certified" promises and describes the methods.

#include "kernels/roots/root_method.h"

namespace oktett::roots {

// ---- Real roots of a polynomial in an interval.

/// In answers in lanes, stands for a root that is not there; sorts behind all others.
inline constexpr double kNoRoot = __builtin_huge_val();

/// c[0] + c[1] x + ... + c[degree] x^degree. A degree of -1 is the zero polynomial.
struct Polynomial {
  int degree = -1;
  double c[kMaxDegree + 1];
};

/// A root, or several too close to each other to be told apart. All that is meant lies in [x - error, x +
/// error].
struct Root {
  double x;
  double error;
  /// 1: exactly one root, simple. m > 1: at most m roots counted with multiplicity, and m minus their number
  /// is even, so an odd m holds at least one. An even m may hold none: then the polynomial comes as near to
  /// zero there as docs/roots.md, "Clusters", says.
  int multiplicity;
};

/// The answer: roots in ascending order. Fixed capacity, nothing is allocated.
struct Roots {
  int count = 0;
  /// Every root in the interval lies in one of the reported intervals, and these hold what `multiplicity`
  /// says. False where the method cannot prove it, which methods without certificate never can.
  bool certified = false;
  /// The polynomial is zero everywhere; no roots are listed.
  bool everywhere = false;
  Root root[kMaxDegree];

  void add(const Root& r) {
    if (count < kMaxDegree) root[count++] = r;
  }
};

// ---- solve(): the common interface of all root finders.

/// "auto", "closed", "bernstein", "sturm", "laguerre", "bisection", "newton".
const char* to_string(Method method);

/// The real roots of p in [a, b], ends included, in ascending order; at most `wanted` of them, the least
/// first. The coefficients and ends are taken as exact; ends may be infinite. A root whose interval reaches
/// over an end of [a, b] may be just outside.
///
/// An interval with a > b is empty. A coefficient that is NaN or infinite, an end that is NaN or a degree
/// above kMaxDegree gives no roots and is not certified. `automatic` is the fastest of the certified methods
/// for the degree; `closed` is `bernstein` above degree 4.
Roots solve(const Polynomial& p, double a, double b, Method method = Method::automatic,
            int wanted = kMaxDegree);

}  // namespace oktett::roots
