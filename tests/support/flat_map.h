#pragma once
/// \file Maps that flatten what they map, so that lengths and right angles before and after have little in
/// common.

#include <cmath>

#include "core/transform.h"
#include "tests/support/dice.h"

namespace oktett {

/// A coordinate that floats hold exactly, or one that they do not.
inline double random_coordinate(Dice<float>& dice) {
  switch (dice.below(3)) {
    case 0:
      return dice.below(9) - 4;
    case 1:
      return double(dice.range(-4, 4));
    default:
      return double(dice.range(-4, 4)) + std::ldexp(1.0, -dice.below(80));
  }
}

inline Vec3d random_point(Dice<float>& dice) {
  const double x = random_coordinate(dice), y = random_coordinate(dice);
  return {x, y, random_coordinate(dice)};
}

/// A map that turns, flattens along one axis by a power of two that is less than 2^`most`, and turns again:
/// its inverse, computed in double, has lost as many digits.
inline Affine random_flat_map(Dice<float>& dice, int most) {
  const Affine first = Affine::rotation(Vec3d(dice.vec(180)));
  const Affine flat = Affine::scaling({1, std::ldexp(1.0, -dice.below(most)), 1});
  return Affine::translation(random_point(dice)) * Affine::rotation(Vec3d(dice.vec(180))) * flat * first;
}

}  // namespace oktett
