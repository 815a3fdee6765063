#pragma once
/// \file Light on its way straight through surfaces: what holes, boundaries and smooth glass leave of it.

#include <cstdint>

#include "core/vec3.h"

namespace oktett {

/// What one surface does to light that is taken straight through it.
struct StraightPassage {
  Color passed;         ///< the part that goes on, through holes or glass
  float reflected = 0;  ///< the part of light inside that its glass sends back inside
  bool front = true;    ///< the light enters the glass, as followed from the receiver
};

/// A ray of light that is taken straight. Light that both faces of a solid reflect to each other leaves it in
/// the end, too: for a pane the sum over all such reflections is exact, for other solids this is as if their
/// faces were parallel where the ray crosses them.
struct StraightLight {
  Color light{1, 1, 1};
  Color between{0, 0, 0};           ///< what returns to the next face after reflection there and at the last
  std::uint32_t entered = kNobody;  ///< the material that the last surface led into; of a combination, its
                                    ///< faces may be those of several objects

  static constexpr std::uint32_t kNobody = 0xffffffff;

  /// Between surfaces.
  void lose(const Color& left) { light = light * left, between = between * left * left; }
  /// At a surface of a material.
  void pass(const StraightPassage& p, std::uint32_t material) {
    light = light * p.passed;
    for (int k = 0; k < 3 && !p.front && entered == material; ++k)
      if (const float rest = 1 - between[k] * p.reflected; rest > 0) light[k] /= rest;
    entered = p.front ? material : kNobody;
    between = Color{1, 1, 1} * p.reflected;
  }
};

}  // namespace oktett
