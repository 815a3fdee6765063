#pragma once
/// \file Independent functions of the exact surfaces, in long double, and what is asked of the tracer by
/// them: dense sampling along a ray, then bisection.

#include <functional>
#include <string>
#include <vector>

#include "kernels/exact_form.h"
#include "verify/cases/kernel_cases.h"

namespace oktett {

using Vec3l = Vec3<long double>;

/// An exact surface and what it should be.
struct ExactOracle {
  std::string name;
  ExactShape shape;
  /// Negative inside, positive outside, for points in the space in which the shape is described. Written from
  /// the source's equation, not from the kernel.
  std::function<long double(const Vec3l&)> f;
  Vec3d lo, hi;  ///< the surface lies in this box, or what of it is looked at
  /// If set, the surface is only where this is not positive: what is open ends there.
  std::function<long double(const Vec3l&)> where;
};

/// One of each form, with parameters from `random`. Grows by one line per form.
std::vector<ExactOracle> draw_exact_oracles(CaseRandom& random);
/// Names of what draw_exact_oracles draws, in its order.
std::vector<std::string> exact_oracle_names();

}  // namespace oktett
