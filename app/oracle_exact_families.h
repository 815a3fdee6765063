#pragma once
/// \file The oracles of each family of exact surfaces.

#include <vector>

#include "app/oracle_exact.h"

namespace oktett {

using DrawExact = ExactOracle (*)(CaseRandom&);

/// Cylinders, cones, polyhedra and quadrics.
std::vector<DrawExact> quadric_oracles();

}  // namespace oktett
