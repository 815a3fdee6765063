#pragma once
/// \file What describes a fractal landscape.

#include <cstdint>

#include "core/description.h"

namespace oktett {

/// Most levels; finer ones would be smaller than a float can tell apart.
inline constexpr int kMaxTerrainDepth = 24;

/// A landscape over the square [-1, 1]^2 of x and z, by midpoint displacement (A. Fournier, D. Fussell,
/// L. Carpenter: Computer Rendering of Stochastic Models, 1982): the middle of an edge is moved up or down
/// from the mean of its ends, the middle of a cell from the mean of its corners, `depth` times. What is
/// between the surface and the plane y = base is solid.
struct TerrainShape {
  std::uint32_t depth = 10;
  std::uint32_t seed = 0;
  double height = 0.5;
  double roughness = 0.5;
  double base = -1;

  static constexpr ShapeInfo kShapeInfo{"terrain", "a random landscape over the square [-1, 1]² of x and z"};
  void describe(auto& p) {
    p.field("depth", depth, whole(0, kMaxTerrainDepth), "2^depth cells to the side");
    p.field("seed", seed, whole(0, 0xffffffff), "which of many landscapes");
    p.field("height", height, kLength, "the most that the corners are moved");
    p.field("roughness", roughness, {0, 1, false, true}, "how much less each finer level is moved");
    p.field("base", base, kCoordinate, "height of the floor");
  }
};

}  // namespace oktett
