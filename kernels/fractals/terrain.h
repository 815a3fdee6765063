#pragma once
/// \file Fractal landscapes by midpoint displacement (A. Fournier, D. Fussell, L. Carpenter: Computer
/// Rendering of Stochastic Models, 1982), found cell by cell while the ray descends.
///
/// The middle of an edge depends on the ends of that edge and on a number drawn for its place alone, so both
/// cells beside the edge find the same heights, whatever way leads to them. The heights in a cell are means
/// of its corners and of displacements, whose sum is bounded: that bounds a cell before it is divided.

#include <vector>

#include "kernels/fractals/fractal.h"
#include "kernels/fractals/terrain_data.h"

namespace oktett {

struct TerrainElement {
  int depth;
  std::uint32_t seed;
  double side;        ///< cells to the side, 2^depth
  double base, high;  ///< the floor, and above all heights
  /// Of each level, how far its points are moved at most, and how far those of all finer levels together.
  double step[kMaxTerrainDepth + 1], rest[kMaxTerrainDepth + 1];
};

/// Parts: 0 the landscape, else walls and floor as faces as in LineRange.
struct Terrain : Fractal<Terrain, TerrainShape, TerrainElement> {
  static void add(Pool& pool, const TerrainShape& shape, const ExactPlace& place);
  static int find(const Element& element, const FractalQuery& query, FractalCrossing* out, int room);
  static bool inside(const Pool& pool, std::size_t i, const Vec3d& p);
  /// How far point (i, k) of the grid of 2^level cells to the side is moved, for a step of 1: from -1 to 1.
  /// Drawn from its place alone.
  static double displacement(std::uint32_t seed, int level, std::uint64_t i, std::uint64_t k);
};

}  // namespace oktett
