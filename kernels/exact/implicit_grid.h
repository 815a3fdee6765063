#pragma once
/// \file A grid over the box of a function, with bounds on how the function varies in each cell. It lets rays
/// pass over the cells by long steps (kernels/exact/implicit.h).

#include <memory>
#include <vector>

#include "core/vec3.h"
#include "kernels/exact/cell_tree.h"
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

// ---- The box of a function, divided into cells that the surface passes through. In each cell a shorter
// tape computes the function: the branches of `min` and `max` that are never taken there are left out (M. J.
// Keeter: Massively parallel rendering of complex closed-form implicit surfaces, 2020).

struct FunctionCells {
  std::vector<FunctionTape> tapes;   ///< each is that of one cell or of several
  std::vector<VariationGrid> grids;  ///< one for each cell, of the tape that counts there; see implicit.h
  CellTree tree;                     ///< without lists: CellNode::first of a leaf is the number of its tape
  std::uint32_t root = 0;

  std::size_t bytes() const;
};

/// What divide_function is asked for: the box of a function, lo < hi, in an element's own space.
struct FunctionBox {
  Vec3d lo, hi;
  double size;  ///< a power of two: so many units of the function's are 1 in the own space
  bool open;    ///< without the faces of the box
};

/// Divides the box of an element's function and appends its cells to `cells`. ExactCell::begin is the number
/// of the cell's tape, ExactCell::count that of its grid plus one. Where the faces of the box close the
/// solid, the inside next to them consists of cells whose tape is a negative constant.
///
/// Returns null, and appends nothing, where cells would not save time: the function has no branches, or they
/// matter everywhere.
std::shared_ptr<const FunctionCells> divide_function(const FunctionTape& function, const FunctionBox& box,
                                                     std::uint32_t element, std::vector<ExactCell>& cells);

}  // namespace oktett
