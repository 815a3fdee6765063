#pragma once
/// \file solve(): the common interface of all root finders.

#include "kernels/roots/roots.h"

namespace oktett::roots {

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
