#pragma once
/// \file The oracles of each family of exact surfaces.

#include <vector>

#include "verify/oracles/exact.h"

namespace oktett {

using DrawExact = ExactOracle (*)(CaseRandom&);

/// Cylinders, cones, polyhedra and quadrics.
std::vector<DrawExact> quadric_oracles();
/// Polynomials, blobs of inverse squares and surfaces of revolution.
std::vector<DrawExact> polynomial_oracles();
/// Superquadrics and ratioquadrics.
std::vector<DrawExact> superquadric_oracles();
/// Metaballs and blob trees.
std::vector<DrawExact> metaball_oracles();
std::vector<DrawExact> blobtree_oracles();
/// Functions of the user's own.
std::vector<DrawExact> function_oracles();
/// Fractals.
std::vector<DrawExact> fractal_oracles();
/// Height fields, open and solid.
std::vector<DrawExact> height_oracles();

}  // namespace oktett
