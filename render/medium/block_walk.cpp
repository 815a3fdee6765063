#include "render/medium/block_walk.h"

#include <algorithm>

namespace oktett {

BlockWalk::BlockWalk(const DensityGrid& grid, const Vec3d& origin, const Vec3d& direction, double length)
    : grid_(grid), end_(length) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double most = grid.size(axis) - 1.0;
    if (direction[axis] == 0) {
      // The comparison sorts out NaN.
      if (!(origin[axis] >= 0 && origin[axis] <= most)) end_ = -1;
      continue;
    }
    const double a = -origin[axis] / direction[axis], b = (most - origin[axis]) / direction[axis];
    if (!(std::min(a, b) <= std::max(a, b))) end_ = -1;
    begin_ = std::max(begin_, std::min(a, b)), end_ = std::min(end_, std::max(a, b));
  }
  if (!(begin_ < end_)) return;
  for (int axis = 0; axis < 3; ++axis) {
    const double place = (origin[axis] + direction[axis] * begin_) / DensityGrid::kBlock;
    block_[axis] = static_cast<int>(std::clamp(place, 0.0, grid.blocks(axis) - 1.0));
    step_[axis] = direction[axis] > 0 ? 1 : -1;
    const int border = block_[axis] + (direction[axis] > 0 ? 1 : 0);
    const bool moves = direction[axis] != 0;
    crossing_[axis] = moves ? (border * DensityGrid::kBlock - origin[axis]) / direction[axis] : kNever;
    across_[axis] = moves ? DensityGrid::kBlock / std::max(direction[axis], -direction[axis]) : kNever;
  }
}

bool BlockWalk::next(BlockSpan& span) {
  if (!(begin_ < end_)) return false;
  int axis = 0;
  if (crossing_[1] < crossing_[axis]) axis = 1;
  if (crossing_[2] < crossing_[axis]) axis = 2;
  span = {begin_, std::clamp(crossing_[axis], begin_, end_),
          grid_.block_most(block_[0], block_[1], block_[2])};
  begin_ = span.end;
  crossing_[axis] += across_[axis];
  block_[axis] += step_[axis];
  if (block_[axis] < 0 || block_[axis] >= grid_.blocks(axis)) {
    span.end = end_;
    begin_ = end_;
  }
  return true;
}

}  // namespace oktett
