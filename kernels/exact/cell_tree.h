#pragma once
/// \file The space of an element, divided until few of its parts matter in each cell. Cells in which the
/// function surely has no zero are left out, so that the scene's tree leads rays to the surface past them.
///
/// Cells overlap by kCellOverlap, and what matters in them is what matters in twice that: a crossing at a
/// border is found in one of them at least.

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/exact/exact.h"

namespace oktett {

/// In the element's own space, which is about 1 in size.
inline constexpr double kCellOverlap = 0x1p-30;

struct CellBox {
  Vec3d lo, hi;
};

/// The square of x, 0 below 0: of distances that are negative inside.
inline double clamp_square(double x) { return x > 0 ? x * x : 0; }

/// A function's values in a box.
struct CellRange {
  double lo, hi;
};

/// What a function is made of. Called by several threads at once.
class CellRule {
 public:
  virtual ~CellRule() = default;
  /// Encloses the function in a box. `part` is what matters in a box around it; `out` becomes what matters in
  /// this one.
  virtual CellRange narrow(const CellBox& box, std::span<const std::uint32_t> part,
                           std::vector<std::uint32_t>& out) const = 0;
  /// Cells shorter than this are not divided.
  virtual double least_size(std::span<const std::uint32_t> part) const = 0;
  /// Time to look for crossings in a cell, in units of the time to visit a node.
  virtual double cost(std::span<const std::uint32_t> part) const = 0;
};

struct CellNode {
  enum class Kind : std::uint8_t { x, y, z, leaf, outside, inside };
  double split = 0;
  std::uint32_t first = 0, second = 0;  ///< the halves; of a leaf, the beginning and length of its list
  Kind kind = Kind::outside;
};

/// The cells' lists, and where to find the cell of a point.
struct CellTree {
  std::vector<CellNode> nodes;
  std::vector<std::uint32_t> lists;
  /// Work that all elements together may take beyond what is meant for each.
  std::int64_t spare = std::int64_t{1} << 26;

  /// Divides `box`, in all of which `part` may matter, for the element; returns the root of its nodes. The
  /// cells are appended to `cells` and refer to `lists`. In parallel; the same for any number of threads.
  ///
  /// The work grows with the number of parts alone: if cells as small as the rule wants them would be too
  /// many, because something is small beside the box and yet everywhere in it, larger ones must do, first of
  /// all where few parts matter.
  std::uint32_t divide(const CellRule& rule, const CellBox& box, std::span<const std::uint32_t> part,
                       std::uint32_t element, std::vector<ExactCell>& cells);
  /// The leaf below `root` that a point in the box is in. Points that are not in it lead anywhere.
  const CellNode& leaf_at(std::uint32_t root, const Vec3d& p) const;
  /// Calls f(leaf, lanes) for each of the leaves that the points of lanes are in. Their lanes go down
  /// together as far as they have the same way.
  template <class D, class Function>
  OKTETT_INLINE void each_leaf(std::uint32_t root, const Vec3<D>& p, Function&& f) const {
    struct Group {
      std::uint32_t node;
      unsigned lanes;
    };
    const D* axes[3] = {&p.x, &p.y, &p.z};
    // What waits has other lanes than what goes down.
    Group waiting[D::kWidth];
    int size = 0;
    for (Group group{root, bits(D::M::all_true())};; group = waiting[--size]) {
      const CellNode* node = &nodes[group.node];
      while (node->kind <= CellNode::Kind::z) {
        const unsigned first = group.lanes & bits(*axes[static_cast<int>(node->kind)] < D(node->split));
        if (first != 0 && first != group.lanes) {
          waiting[size++] = {node->second, group.lanes & ~first};
          group.lanes = first;
        }
        node = &nodes[first != 0 ? node->first : node->second];
      }
      f(*node, D::M::from_bits(group.lanes));
      if (size == 0) return;
    }
  }
  std::size_t bytes() const { return nodes.size() * sizeof(CellNode) + lists.size() * sizeof(std::uint32_t); }
};

}  // namespace oktett
