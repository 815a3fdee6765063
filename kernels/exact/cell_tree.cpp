#include "kernels/exact/cell_tree.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <utility>

#include "core/parallel.h"

namespace oktett {

namespace {

constexpr int kMaxDepth = 64;
/// Halves of boxes in which fewer parts matter are not worth a task.
constexpr std::size_t kTaskSize = 64;
/// Parts that may be looked at for the cells of an element: so many for each of its own parts, and as long as
/// CellTree::spare lasts, more for elements of few parts.
constexpr std::int64_t kWorkPerPart = 1 << 12, kMostSpare = 1 << 20;
/// By which cells grow from one attempt to the next.
constexpr double kCoarser = 16;
/// Time to visit a node of the scene's tree.
constexpr double kNodeCost = 1;

CellBox widened(const CellBox& box, double by) {
  const Vec3d d{by, by, by};
  return {box.lo - d, box.hi + d};
}

double area(const CellBox& box) {
  const Vec3d e = box.hi - box.lo;
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

/// What one attempt may cost. Whether it costs more does not depend on the order in which threads work.
struct DivisionEffort {
  double coarseness;
  std::atomic<std::int64_t> left;
};

/// Divides to the end, then keeps the divisions that are expected to save time (surface area heuristic).
class Division {
 public:
  Division(const CellRule& rule, DivisionEffort& effort, CellTree& tree, std::uint32_t element,
           std::vector<ExactCell>& cells)
      : rule_(rule), effort_(effort), tree_(tree), element_(element), cells_(cells) {}

  struct Part {
    std::uint32_t node;
    CellBox box;  ///< of the cells
    double cost;  ///< of a ray through them, times the area of their boxes; 0 if there are none
  };

  Part grow(const CellBox& box, std::span<const std::uint32_t> around, int depth) {
    std::vector<std::uint32_t> part;
    const CellRange range = rule_.narrow(widened(box, 2 * kCellOverlap), around, part);
    const auto node = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.push_back({});
    // What comes of an attempt that costs too much is thrown away.
    if ((effort_.left -= static_cast<std::int64_t>(around.size()) + 1) < 0) return finish(node, true);
    if (range.lo > 0 || range.hi < 0) return finish(node, range.lo > 0);
    const Vec3d e = box.hi - box.lo;
    const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
    if (depth >= kMaxDepth || !(e[axis] > least_size(part))) return leaf(node, box, part);

    const std::size_t nodes = tree_.nodes.size(), lists = tree_.lists.size(), cells = cells_.size();
    CellBox low = box, high = box;
    const double split = box.lo[axis] + e[axis] / 2;
    low.hi[axis] = high.lo[axis] = split;
    const auto [a, b] = grow_both(low, high, part, depth + 1);
    if (a.cost == 0 && b.cost == 0 && tree_.nodes[a.node].kind == tree_.nodes[b.node].kind) {
      const bool outside = tree_.nodes[a.node].kind == CellNode::Kind::outside;
      tree_.nodes.resize(nodes);
      return finish(node, outside);
    }
    tree_.nodes[node] = {split, a.node, b.node, static_cast<CellNode::Kind>(axis)};
    if (a.cost == 0 && b.cost == 0) return {node, box, 0};
    const CellBox both = a.cost == 0   ? b.box
                         : b.cost == 0 ? a.box
                                       : CellBox{min(a.box.lo, b.box.lo), max(a.box.hi, b.box.hi)};
    const double divided = a.cost + b.cost + area(both) * kNodeCost;
    if (area(both) * rule_.cost(part) > divided) return {node, both, divided};
    tree_.nodes.resize(nodes), tree_.lists.resize(lists), cells_.resize(cells);
    return leaf(node, both, part);
  }

 private:
  double least_size(const std::vector<std::uint32_t>& part) const {
    const double n = static_cast<double>(part.size());
    return rule_.least_size(part) * std::max(1.0, effort_.coarseness / (n * n));
  }

  std::pair<Part, Part> grow_both(const CellBox& low, const CellBox& high,
                                  const std::vector<std::uint32_t>& part, int depth) {
    if (part.size() < kTaskSize) {
      const Part a = grow(low, part, depth);
      return {a, grow(high, part, depth)};
    }
    CellTree other;
    std::vector<ExactCell> cells;
    Part a, b;
    run_both([&] { a = grow(low, part, depth); },
             [&] { b = Division(rule_, effort_, other, element_, cells).grow(high, part, depth); });
    b.node = append(other, cells, b.node);
    return {a, b};
  }

  /// Puts a part that grew by itself behind what there is; where its node `root` comes to stand.
  std::uint32_t append(const CellTree& other, const std::vector<ExactCell>& cells, std::uint32_t root) {
    const auto nodes = static_cast<std::uint32_t>(tree_.nodes.size());
    const auto lists = static_cast<std::uint32_t>(tree_.lists.size());
    for (CellNode node : other.nodes) {
      if (node.kind <= CellNode::Kind::z) node.first += nodes, node.second += nodes;
      if (node.kind == CellNode::Kind::leaf) node.first += lists;
      tree_.nodes.push_back(node);
    }
    tree_.lists.insert(tree_.lists.end(), other.lists.begin(), other.lists.end());
    for (ExactCell cell : cells) {
      cell.begin += lists;
      cells_.push_back(cell);
    }
    return root + nodes;
  }

  Part finish(std::uint32_t node, bool outside) {
    tree_.nodes[node].kind = outside ? CellNode::Kind::outside : CellNode::Kind::inside;
    return {node, {}, 0};
  }

  Part leaf(std::uint32_t node, const CellBox& box, const std::vector<std::uint32_t>& part) {
    const auto begin = static_cast<std::uint32_t>(tree_.lists.size());
    const auto count = static_cast<std::uint32_t>(part.size());
    tree_.lists.insert(tree_.lists.end(), part.begin(), part.end());
    tree_.nodes[node] = {0, begin, count, CellNode::Kind::leaf};
    const CellBox wide = widened(box, kCellOverlap);
    cells_.push_back({wide.lo, wide.hi, element_, begin, count});
    return {node, box, area(box) * rule_.cost(part)};
  }

  const CellRule& rule_;
  DivisionEffort& effort_;
  CellTree& tree_;
  std::uint32_t element_;
  std::vector<ExactCell>& cells_;
};

}  // namespace

std::uint32_t CellTree::divide(const CellRule& rule, const CellBox& box, std::span<const std::uint32_t> part,
                               std::uint32_t element, std::vector<ExactCell>& cells) {
  const std::size_t nodes_before = nodes.size(), lists_before = lists.size(), cells_before = cells.size();
  const std::int64_t own = kWorkPerPart * static_cast<std::int64_t>(part.size() + 1);
  for (double coarseness = 1;; coarseness *= kCoarser) {
    const std::int64_t work = own + std::min(kMostSpare, spare);
    DivisionEffort effort{coarseness, work};
    const std::uint32_t root = Division(rule, effort, *this, element, cells).grow(box, part, 0).node;
    spare -= std::max<std::int64_t>(work - std::max<std::int64_t>(effort.left, 0) - own, 0);
    if (effort.left >= 0) return root;
    nodes.resize(nodes_before), lists.resize(lists_before), cells.resize(cells_before);
  }
}

const CellNode& CellTree::leaf_at(std::uint32_t root, const Vec3d& p) const {
  const CellNode* node = &nodes[root];
  while (node->kind <= CellNode::Kind::z)
    node = &nodes[p[static_cast<int>(node->kind)] < node->split ? node->first : node->second];
  return *node;
}

}  // namespace oktett
