#pragma once
/// \file Files of densities on a grid. Within io/ only.

#include <memory>
#include <string>

#include "render/medium/density_grid.h"

namespace oktett {

/// Reads a file that begins with the lines
///
///     oktett density grid 1
///     size NX NY NZ
///     values float32                 (or: values text)
///
/// and goes on with NX * NY * NZ densities, x fastest, then y, then z: floats of 32 bits in little-endian
/// order, or numbers parted by blanks and line ends. Files that end in `.df3` are POV-Ray's: three sides,
/// then values of 1, 2 or 4 bytes, all most significant byte first, from 0 to the greatest as 0 to 1. They
/// lie at the lower corners of cells and repeat, so that the grid has one more along each axis. Throws Error
/// that names the line, or the value, and what was expected.
std::shared_ptr<const DensityGrid> read_density_file(const std::string& path);

}  // namespace oktett
