#include "io/mesh/blocker_tree.h"

#include <numeric>

namespace oktett {

/// Corners in a leaf: polygons of about this size need no tree.
static constexpr std::size_t kLeafSize = 16;

void BlockerTree::build(const std::vector<PlanePoint>& points) {
  first_leaf_ = 1;
  while (points.size() > kLeafSize * first_leaf_) first_leaf_ *= 2;
  order_.resize(points.size());
  std::iota(order_.begin(), order_.end(), 0u);
  leaf_of_.resize(points.size());
  boxes_.resize(std::size_t{2} * first_leaf_);
  blocking_.assign(std::size_t{2} * first_leaf_, 0);
  split(points, 1, 0, first_leaf_);
}

/// Makes `node`, which has the leaves from `leaf` on.
void BlockerTree::split(const std::vector<PlanePoint>& points, std::uint32_t node, std::size_t leaf,
                        std::size_t leaves) {
  const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(begin_of(leaf));
  const auto end = order_.begin() + static_cast<std::ptrdiff_t>(begin_of(leaf + leaves));
  Box box{points[*begin], points[*begin]};
  for (auto it = begin; it != end; ++it) {
    const PlanePoint& p = points[*it];
    box.lo = {std::min(box.lo.x, p.x), std::min(box.lo.y, p.y)};
    box.hi = {std::max(box.hi.x, p.x), std::max(box.hi.y, p.y)};
  }
  boxes_[node] = box;
  if (leaves == 1) {
    for (auto it = begin; it != end; ++it) leaf_of_[*it] = node;
    return;
  }
  const bool along_x = box.hi.x - box.lo.x >= box.hi.y - box.lo.y;
  const auto middle = order_.begin() + static_cast<std::ptrdiff_t>(begin_of(leaf + leaves / 2));
  std::nth_element(begin, middle, end, [&](std::uint32_t i, std::uint32_t j) {
    return along_x ? points[i].x < points[j].x : points[i].y < points[j].y;
  });
  split(points, 2 * node, leaf, leaves / 2);
  split(points, 2 * node + 1, leaf + leaves / 2, leaves / 2);
}

}  // namespace oktett
