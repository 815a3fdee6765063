#pragma once
/// \file What describes fractals: shapes that repeat themselves at ever smaller sizes, down to a depth.
/// Nothing of them is stored but these numbers.

#include <cstdint>
#include <vector>

#include "core/transform.h"

namespace oktett {

/// Most levels of each kind. What is finer than a float can tell from its neighbours serves nobody.
inline constexpr int kMaxSphereflakeDepth = 24;
inline constexpr int kMaxMengerDepth = 16;
inline constexpr int kMaxIfsDepth = 32;
inline constexpr int kMaxIfsMaps = 64;
inline constexpr int kMaxJuliaIterations = 24;
inline constexpr int kMaxTerrainDepth = 24;

/// A ball of radius 1 about the origin with nine children, balls of radius `ratio` that touch it: six around
/// the equator of its y axis and three above, as the neighbours in the densest packing. Each child's y axis
/// points away from its parent (E. Haines: A Proposal for Standard Graphics Environments, 1987).
struct SphereflakeShape {
  std::uint32_t depth = 4;  ///< generations below the first ball; at most kMaxSphereflakeDepth. Those smaller
                            ///< than 2^-40 of it are left out
  double ratio = 1.0 / 3.0;  ///< of a child's radius to its parent's; > 0, at most 1/2
};

/// The cube [-1, 1]^3, cut into 27 equal ones, without those in the middles of the faces and of the whole;
/// the same again with each of the others, `depth` times (K. Menger: Allgemeine Räume und Cartesische Räume,
/// 1926).
struct MengerShape {
  std::uint32_t depth = 4;  ///< at most kMaxMengerDepth; 0 is the cube
};

/// An iterated function system: the base, moved by `depth` of the maps in all orders (M. Barnsley: Fractals
/// Everywhere, 1988). The union of all pieces is a solid.
struct IfsShape {
  enum class Base : std::uint8_t {
    ball,  ///< of radius 1 about the origin
    box,   ///< [-1, 1]^3
  };
  std::vector<Affine> maps;  ///< 1 to kMaxIfsMaps, invertible contractions
  std::uint32_t depth = 8;   ///< at most kMaxIfsDepth
  Base base = Base::ball;
  double least = 0;          ///< pieces of no more than this part of the base's size are not divided; >= 0
  bool every_level = false;  ///< with the pieces that have been divided, too
};

/// The points q = x + y i + z j + slice k whose first `iterations` images under q -> q^2 + c stay in the ball
/// of radius (1 + sqrt(1 + 4 |c|)) / 2, from outside of which none returns: for ever more of them, the filled
/// Julia set (A. Norton: Generation and Display of Geometric Fractals in 3-D, 1982).
struct JuliaShape {
  double c[4] = {-0.2, 0.8, 0, 0};  ///< |c| <= 2
  double slice = 0;
  std::uint32_t iterations = 10;  ///< 1 to kMaxJuliaIterations
};

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
