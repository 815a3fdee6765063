#pragma once
/// \file The random surfaces of each family, and what their oracles share.

#include <vector>

#include "verify/oracles/enclosure.h"
#include "verify/oracles/exact.h"

namespace oktett {

using Real = long double;

/// How far outside of a box p is, negative inside.
Real outside(const Vec3d& lo, const Vec3d& hi, const Vec3l& p);

/// A clear way by `f`, which takes a box and gives an enclosure of the oracle's function.
template <class F>
ClearWay clear_by(const F& f) {
  return [f](const Vec3d& a, const Vec3d& b) {
    const Enclosure values = f(box_about(a, b));
    // What is infinite may count as outside.
    return values.positive() || (values.negative() && values.lo > -HUGE_VAL);
  };
}

/// Cuts off what is where `where` is positive; what is `open` gets no lid there.
void cut(ExactOracle& oracle, const SurfaceFunction& where, bool open);
/// The same for what is outside of a box, which becomes the oracle's. Only this keeps a clear way.
void cut_by_box(ExactOracle& oracle, const Vec3d& lo, const Vec3d& hi, bool open);

/// A random surface of one form, the same for the same numbers.
struct ExactCase {
  const char* name;
  ExactOracle (*draw)(CaseRandom&);
};

/// Cylinders, cones, polyhedra and quadrics.
std::vector<ExactCase> quadric_cases();
/// Polynomials, blobs of inverse squares and surfaces of revolution.
std::vector<ExactCase> polynomial_cases();
/// Prisms.
std::vector<ExactCase> prism_cases();
/// Sweeps of spheres.
std::vector<ExactCase> sweep_cases();
/// Bezier patches, and surfaces given by functions of two parameters.
std::vector<ExactCase> patch_cases();
std::vector<ExactCase> parametric_cases();
/// Superquadrics and ratioquadrics.
std::vector<ExactCase> superquadric_cases();
/// Metaballs and blob trees.
std::vector<ExactCase> metaball_cases();
std::vector<ExactCase> blobtree_cases();
std::vector<ExactCase> capsule_cases();
/// Functions of the user's own.
std::vector<ExactCase> function_cases();
/// Fractals.
std::vector<ExactCase> fractal_cases();
/// Ovi.
std::vector<ExactCase> ovus_cases();
/// Height fields, open and solid.
std::vector<ExactCase> height_cases();

}  // namespace oktett
