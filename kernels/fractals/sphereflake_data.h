#pragma once
/// \file What describes a sphereflake.

#include <cstdint>

#include "core/description.h"

namespace oktett {

/// Most levels; finer ones would be smaller than a float can tell apart.
inline constexpr int kMaxSphereflakeDepth = 24;

/// A ball of radius 1 about the origin with nine children, balls of radius `ratio` that touch it: six around
/// the equator of its y axis and three above, as the neighbours in the densest packing. Each child's y axis
/// points away from its parent (E. Haines: A Proposal for Standard Graphics Environments, 1987).
struct SphereflakeShape {
  std::uint32_t depth = 4;  ///< balls smaller than 2^-40 of the first are left out
  double ratio = 1.0 / 3.0;

  static constexpr ShapeInfo kShapeInfo{
      "sphereflake", "a ball with nine smaller ones on it, which have smaller ones on them"};
  void describe(auto& p) {
    p.field("depth", depth, whole(0, kMaxSphereflakeDepth), "generations below the first ball of radius 1");
    p.field("ratio", ratio, {0, 0.5, true}, "of a child's radius to its parent's");
  }
};

}  // namespace oktett
