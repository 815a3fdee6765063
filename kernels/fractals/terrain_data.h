#pragma once
/// \file What describes a fractal landscape.

#include <cstdint>

namespace oktett {

/// Most levels; finer ones would be smaller than a float can tell apart.
inline constexpr int kMaxTerrainDepth = 24;

/// A landscape over the square [-1, 1]^2 of x and z, by midpoint displacement (A. Fournier, D. Fussell,
/// L. Carpenter: Computer Rendering of Stochastic Models, 1982): the middle of an edge is moved up or down
/// from the mean of its ends, the middle of a cell from the mean of its corners, `depth` times. What is
/// between the surface and the plane y = base is solid.
struct TerrainShape {
  std::uint32_t depth = 10;  ///< 2^depth cells to the side; at most kMaxTerrainDepth
  std::uint32_t seed = 0;
  double height = 0.5;     ///< the most that the corners are moved, >= 0
  double roughness = 0.5;  ///< how much less the next finer points are moved; >= 0, < 1
  double base = -1;
};

}  // namespace oktett
