#pragma once
/// \file What describes a Menger sponge.

#include <cstdint>

#include "core/description.h"

namespace oktett {

/// Most levels; finer ones would be smaller than a float can tell apart.
inline constexpr int kMaxMengerDepth = 16;

/// The cube [-1, 1]^3, cut into 27 equal ones, without those in the middles of the faces and of the whole;
/// the same again with each of the others, `depth` times (K. Menger: Allgemeine Räume und Cartesische Räume,
/// 1926).
struct MengerShape {
  std::uint32_t depth = 4;

  static constexpr ShapeInfo kShapeInfo{"menger", "Menger's sponge in the cube [-1, 1]³"};
  void describe(auto& p) {
    p.field("depth", depth, whole(0, kMaxMengerDepth), "how often holes are cut; 0 is the cube");
  }
};

}  // namespace oktett
