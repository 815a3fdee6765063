#pragma once
/// \file What describes a sphereflake.

#include <cstdint>

namespace oktett {

/// Most levels; finer ones would be smaller than a float can tell apart.
inline constexpr int kMaxSphereflakeDepth = 24;

/// A ball of radius 1 about the origin with nine children, balls of radius `ratio` that touch it: six around
/// the equator of its y axis and three above, as the neighbours in the densest packing. Each child's y axis
/// points away from its parent (E. Haines: A Proposal for Standard Graphics Environments, 1987).
struct SphereflakeShape {
  std::uint32_t depth = 4;  ///< generations below the first ball; at most kMaxSphereflakeDepth. Those smaller
                            ///< than 2^-40 of it are left out
  double ratio = 1.0 / 3.0;  ///< of a child's radius to its parent's; > 0, at most 1/2
};

}  // namespace oktett
