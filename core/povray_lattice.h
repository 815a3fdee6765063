#pragma once
/// \file What stands at the points of the lattice of POV-Ray's noise (core/povray_noise.h).

#include <cstdint>

namespace oktett {

/// Of each corner of a cell, whose number has coordinate k of the corner in bit k: four numbers, the value of
/// the noise and its slopes along x, y and z.
void povray_corners(std::int64_t x, std::int64_t y, std::int64_t z, const double* (&corners)[8]);

}  // namespace oktett
