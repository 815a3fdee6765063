#pragma once
/// \file The blocks of a DensityGrid along a ray, in order (Amanatides and Woo 1987).

#include <limits>

#include "render/medium/density_grid.h"

namespace oktett {

/// A part of a ray within one block.
struct BlockSpan {
  double begin = 0, end = 0;  ///< distances along the ray
  double most = 0;            ///< no density in it is greater
};

class BlockWalk {
 public:
  /// Origin and direction in units of cells; the part of the ray from 0 to `length` is walked.
  BlockWalk(const DensityGrid& grid, const Vec3d& origin, const Vec3d& direction, double length);

  /// The next block; false behind the last one.
  bool next(BlockSpan& span);

 private:
  const DensityGrid& grid_;
  double begin_ = 0, end_ = 0;
  int block_[3] = {}, step_[3] = {};
  double crossing_[3] = {}, across_[3] = {};  ///< distance to the next border along each axis, and between
                                              ///< two borders
};

}  // namespace oktett
