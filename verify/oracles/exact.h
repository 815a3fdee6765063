#pragma once
/// \file Independent functions of the exact surfaces, in long double, and bounds that say where they have no
/// zero.

#include <functional>
#include <string>
#include <vector>

#include "kernels/exact_form.h"
#include "verify/cases/kernel_cases.h"

namespace oktett {

using Vec3l = Vec3<long double>;
using SurfaceFunction = std::function<long double(const Vec3l&)>;

/// M p + t; with `one` = 0 the vector M p.
Vec3l mapped(const Affine& m, const Vec3l& p, long double one = 1);

/// Where f changes its sign between t0 and t1, by bisection.
template <class F>
long double bisected(const F& f, long double t0, long double t1) {
  const bool negative = f(t0) < 0;
  for (int k = 0; k < 64; ++k) {
    const long double mid = t0 + (t1 - t0) / 2;
    ((f(mid) < 0) == negative ? t0 : t1) = mid;
  }
  return t0 + (t1 - t0) / 2;
}

/// Whether a function surely keeps its sign all the way from a to b, or changes it only where no surface is.
/// False where that is not clear. The points may be off by 2^-52 of their coordinates.
using ClearWay = std::function<bool(const Vec3d& a, const Vec3d& b)>;

/// An exact surface and what it should be.
struct ExactOracle {
  ExactShape shape;
  /// Negative inside, positive outside, for points in the space in which the shape is described. Written from
  /// the source's equation, not from the kernel.
  SurfaceFunction f;
  Vec3d lo{1e9, 1e9, 1e9}, hi = -lo;  ///< the surface lies in this box, or what of it is looked at
  /// If set, the surface is only where this is not positive: what is open ends there.
  SurfaceFunction where = {};
  std::string name = {};
  /// If set, what spares a search the stretches of a ray where nothing is. By bounds of its own: not from the
  /// kernel.
  ClearWay clear = {};

  /// Makes the box hold a ball.
  void grow(const Vec3d& center, double radius);
};

// What shapes should be.
ExactOracle oracle_of(const TorusShape& shape);
ExactOracle oracle_of(const CylinderShape& shape);
ExactOracle oracle_of(const ConeShape& shape);
/// The box is left to the caller.
ExactOracle oracle_of(const PolyhedronShape& shape);
ExactOracle oracle_of(const QuadricShape& shape);
ExactOracle oracle_of(const PolynomialShape& shape);
ExactOracle oracle_of(const RevolutionShape& shape);
ExactOracle oracle_of(const PrismShape& shape);
ExactOracle oracle_of(const SphereSweepShape& shape);
ExactOracle oracle_of(const SuperquadricShape& shape);
ExactOracle oracle_of(const MetaballsShape& shape);

/// Number `form` of exact_oracle_names, with parameters from `random`.
ExactOracle draw_exact_oracle(std::size_t form, CaseRandom& random);
/// One of each form.
std::vector<ExactOracle> draw_exact_oracles(CaseRandom& random);
/// Names of what draw_exact_oracles draws, in its order.
std::vector<std::string> exact_oracle_names();
/// The key of the random numbers of shape number `trial` of a form.
std::uint64_t exact_key(std::size_t form, std::uint64_t trial);
/// A random rotation, often with different scales along the axes, sometimes nothing.
Affine random_turn(CaseRandom& random);

}  // namespace oktett
