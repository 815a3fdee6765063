#pragma once
/// \file The box of a function, divided into cells that the surface passes through. In each cell a shorter
/// tape computes the function: the branches of `min` and `max` that are never taken there are left out (M. J.
/// Keeter: Massively parallel rendering of complex closed-form implicit surfaces, 2020).

#include <memory>
#include <vector>

#include "kernels/exact/cell_tree.h"
#include "kernels/exact/implicit_grid.h"
#include "kernels/functions/tape_data.h"

namespace oktett {

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
