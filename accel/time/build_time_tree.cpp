#include <algorithm>
#include <limits>

#include "accel/build/build_arrays.h"
#include "accel/build/wide_tree.h"
#include "accel/geometry_bounds.h"
#include "accel/time/time_tree.h"

namespace oktett {
namespace {

class TimeTreeBuilder {
 public:
  TimeTreeBuilder(std::uint32_t keys, const TimeSource& source, TimeTree& tree)
      : keys_(keys), source_(source), tree_(tree) {
    tree_.keys = keys;
  }

  void run(const BuildOptions& options) {
    BuildOptions plain = options;
    // Items cannot be split.
    if (plain.quality == BuildQuality::best) plain.quality = BuildQuality::balanced;
    Accel links;
    ItemOrder order;
    BuildArrays arrays(source_.count(), effort_of(plain.quality));
    for (std::uint32_t i = 0; i < source_.count(); ++i) add_reference(i, arrays, links.bounds);
    if (arrays.count == 0) return;
    build_tree(links, arrays, NoTriangles{}, order, plain, build_kernels(available_isas().back()));
    tree_.root = links.root;
    take_leaves(links, order);
    fit_nodes(links);
  }

 private:
  Box box_at(std::uint32_t item, std::uint32_t key) const {
    if (!source_.is_triangle(item)) return source_.bounds(item, key);
    Vec3f v[3];
    source_.corners(item, key, v);
    Box box;
    for (const Vec3f& p : v) {
      if (!is_finite(p)) return {};
      box.grow(p);
    }
    return box;
  }

  /// The links follow from the boxes in the middle of the time.
  void add_reference(std::uint32_t item, BuildArrays& arrays, Box& bounds) const {
    for (std::uint32_t k = 0; k < keys_; ++k)
      if (!is_usable(box_at(item, k))) return;
    const Box a = box_at(item, (keys_ - 1) / 2), b = box_at(item, keys_ / 2);
    const Box middle{a.lo * 0.5f + b.lo * 0.5f, a.hi * 0.5f + b.hi * 0.5f};
    const Kind kind = source_.is_triangle(item) ? Kind::box : Kind::instance;
    arrays.refs[arrays.count++] = {{-middle.lo.x, -middle.lo.y, -middle.lo.z},
                                   item,
                                   {middle.hi.x, middle.hi.y, middle.hi.z},
                                   static_cast<std::uint32_t>(kind)};
    bounds.grow(middle);
  }

  void take_leaves(const Accel& links, const ItemOrder& order) {
    tree_.leaves = links.leaves;
    tree_.called_items = order[static_cast<int>(Kind::instance)];
    const std::vector<std::uint32_t>& triangles = order[static_cast<int>(Kind::box)];
    for (LeafEntry& leaf : tree_.leaves) {
      if (leaf.kind != Kind::box) continue;
      const std::uint32_t* const items = &triangles[leaf.begin];
      leaf.begin = static_cast<std::uint32_t>(tree_.block_items.size());
      auto& block = tree_.block_items.emplace_back();
      block.fill(kNoId);
      std::copy_n(items, leaf.count, block.begin());
      for (std::uint32_t k = 0; k < keys_; ++k) {
        MovingCorners& corners = tree_.corners.emplace_back();
        for (std::uint32_t lane = 0; lane < TriangleBlock::kSize; ++lane) {
          Vec3f v[3];
          source_.corners(items[lane < leaf.count ? lane : 0], k, v);
          // Unused lanes have the same corner three times.
          for (int c = 0; c < 3; ++c)
            for (int axis = 0; axis < 3; ++axis)
              corners.at[c][axis][lane] = v[lane < leaf.count ? c : 0][axis];
        }
      }
    }
  }

  Box box_of(const LeafEntry& leaf, std::uint32_t key) const {
    Box box;
    for (std::uint32_t i = 0; i < leaf.count; ++i)
      box.grow(box_at(
          leaf.kind == Kind::box ? tree_.block_items[leaf.begin][i] : tree_.called_items[leaf.begin + i],
          key));
    return box;
  }

  static Box box_of(const BvhNode& node) {
    Box box;
    for (int i = 0; i < BvhNode::kWidth; ++i)
      if (!node.child[i].is_none())
        box.grow(Box{{node.plane[0][i], node.plane[2][i], node.plane[4][i]},
                     {node.plane[1][i], node.plane[3][i], node.plane[5][i]}});
    return box;
  }

  Box box_of(NodeRef ref, std::uint32_t key) const {
    if (ref.is_none()) return {};
    return ref.is_leaf() ? box_of(tree_.leaves[ref.table_index()], key)
                         : box_of(tree_.nodes[key][ref.node_index()]);
  }

  /// The boxes at each key, from the leaves to the root. Children come behind their parents.
  void fit_nodes(const Accel& links) {
    const std::size_t count = links.stats.nodes;
    constexpr float most = std::numeric_limits<float>::max();
    for (std::uint32_t k = 0; k < keys_; ++k) {
      VirtualArray<BvhNode>& nodes = tree_.nodes.emplace_back(count);
      for (std::size_t n = count; n-- > 0;) {
        BvhNode& node = nodes[n];
        node = links.nodes[n];
        for (int i = 0; i < BvhNode::kWidth; ++i) {
          const Box box = box_of(node.child[i], k);
          for (int axis = 0; axis < 3; ++axis) {
            node.plane[2 * axis][i] = node.child[i].is_none() ? most : box.lo[axis];
            node.plane[2 * axis + 1][i] = node.child[i].is_none() ? -most : box.hi[axis];
          }
        }
      }
      const Box box = box_of(tree_.root, k);
      tree_.bounds.grow(box);
      if (k == 0) tree_.first = box;
      tree_.last = box;
    }
  }

  const std::uint32_t keys_;
  const TimeSource& source_;
  TimeTree& tree_;
};

}  // namespace

std::unique_ptr<TimeTree> build_time_tree(std::uint32_t keys, const TimeSource& source,
                                          const BuildOptions& options) {
  auto tree = std::make_unique<TimeTree>();
  TimeTreeBuilder(keys, source, *tree).run(options);
  return tree;
}

}  // namespace oktett
