#pragma once
/// \file A point of the unit square: what random decisions are made from.

namespace oktett {

/// A point of the unit square, [0, 1) in both coordinates.
struct SquareSample {
  double x = 0, y = 0;
};

}  // namespace oktett
