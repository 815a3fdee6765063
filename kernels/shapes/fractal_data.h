#pragma once
/// \file What describes fractals: shapes that repeat themselves at ever smaller sizes, down to a depth.
/// Nothing of them is stored but these numbers.

#include <cstdint>

#include "core/vec3.h"

namespace oktett {

/// Most levels of each kind. What is finer than a float can tell from its neighbours serves nobody.
inline constexpr int kMaxSphereflakeDepth = 24;
inline constexpr int kMaxMengerDepth = 16;

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

}  // namespace oktett
