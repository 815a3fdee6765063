#pragma once
/// \file A grid over the box of a function, with bounds on how the function varies in each cell. It lets rays
/// pass over the cells by long steps (kernels/exact/stride.h).

#include <vector>

#include "core/vec3.h"
#include "kernels/functions/tape_data.h"

namespace oktett {

/// What is known of one cell, which is taken to be larger by kGridMargin of its edges on all sides.
struct ImplicitGridCell {
  float bend[2];  ///< the second derivative along a unit direction is at least -bend[0] and at most bend[1]
  /// Bounds the derivative along a unit direction, whose rounding error is less than kSlopeError of this.
  float slope;
  float error;  ///< bounds rounding errors of values, and the width of the enclosure of a point's value
};
static_assert(sizeof(ImplicitGridCell) == 4 * sizeof(float));

inline constexpr double kGridMargin = 0x1p-9, kSlopeError = 0x1p-26;
inline constexpr int kMostGridSide = 8;

/// side^3 cells, x running fastest. Cells of one certain sign have a slope and a bend of 0, so that no step
/// is too long for them; cells of which nothing is known have infinite ones and no error.
struct VariationGrid {
  int side = 0;
  Vec3d lo, per_unit;  ///< of the box; cells per unit
  std::vector<ImplicitGridCell> cells;
};

/// The grid of a function over a box with lo < hi: of 1, 4 or 8 cells a side, but at most `most_side`, as
/// many as make bounds smaller. Functions of many steps get fewer. No cells at all if strides would not pay,
/// or if the box is too small or too large for numbers.
VariationGrid make_variation_grid(const FunctionTape& function, const Vec3d& lo, const Vec3d& hi,
                                  int most_side = kMostGridSide);

}  // namespace oktett
