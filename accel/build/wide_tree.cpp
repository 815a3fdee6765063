/// \file From the binary tree to the wide one. The places of all nodes, blocks and table entries are known
/// before anything is written, so parts are written in parallel.

#include "accel/build/wide_tree.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "accel/build/build_arrays.h"
#include "accel/build/compact_blocks.h"
#include "core/error.h"

namespace oktett {
namespace {

/// The wide tree is written in parts: this many nodes at the top, then the subtrees below them.
constexpr std::size_t kTopNodes = 64;

/// How many nodes, blocks and table entries a subtree takes.
struct Sizes {
  std::uint32_t nodes = 0, blocks = 0, leaves = 0;
  int depth = 0;  ///< of nodes, counted from the root
};

class WideBuilder {
 public:
  WideBuilder(Accel& accel, const BinaryTree& tree, const TriangleSource& triangles, bool parallel)
      : accel_(accel), tree_(tree), triangles_(triangles), parallel_(parallel) {}

  void run() {
    std::vector<Entry> top, parts;
    expand(top, parts);
    // Two passes over each part: one counts, one writes.
    std::vector<Sizes> sizes(parts.size());
    each(parts.size(), [&](std::size_t i) { measure(parts[i].index, parts[i].depth, sizes[i]); });
    std::vector<Sizes> at(parts.size() + 1);
    at[0].nodes = static_cast<std::uint32_t>(top.size());
    std::uint64_t blocks = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      at[i + 1] = {at[i].nodes + sizes[i].nodes, at[i].blocks + sizes[i].blocks,
                   at[i].leaves + sizes[i].leaves, std::max(at[i].depth, sizes[i].depth)};
      blocks += sizes[i].blocks;
    }
    if (blocks > NodeRef::kMaxTriangleLeaves / TriangleBlock::kLeaves)
      throw Error("too many triangles for one structure");
    accel_.nodes = VirtualArray<BvhNode>(at.back().nodes);
    accel_.blocks = VirtualArray<TriangleBlock>(at.back().blocks);
    populate(accel_.nodes.data(), at.back().nodes, parallel_);
    populate(accel_.blocks.data(), at.back().blocks, parallel_);
    accel_.leaves.resize(at.back().leaves);
    for (std::uint32_t i = 0; i < top.size(); ++i) {
      std::uint32_t child[BvhNode::kWidth];
      const NodeRef none[BvhNode::kWidth] = {};
      write_node(accel_.nodes[i], child, none, children(tree_.nodes[top[i].index], child));
      attach(top[i], NodeRef::node(i));
    }
    each(parts.size(), [&](std::size_t i) {
      Sizes next = at[i];
      attach(parts[i], write(parts[i].index, next));
    });
    set_stats(at.back());
  }

 private:
  /// A binary node that becomes wide, and the place that points to it.
  struct Entry {
    std::uint32_t index;
    std::uint32_t parent;  ///< wide node; kNoId: this is the root
    int slot;
    int depth;
  };

  void attach(const Entry& e, NodeRef ref) const {
    (e.parent == kNoId ? accel_.root : accel_.nodes[e.parent].child[e.slot]) = ref;
  }

  template <class Body>
  void each(std::size_t count, Body&& body) const {
    if (parallel_ && count > 1)
      tbb::parallel_for(std::size_t{0}, count, body);
    else
      for (std::size_t i = 0; i < count; ++i) body(i);
  }

  /// The binary nodes that become the children of the wide node made from `n`.
  int children(const BinaryNode& n, std::uint32_t* out) const {
    const int left = n.left_slots(BvhNode::kWidth);
    return gather(n.link, left, gather(n.link + 1, BvhNode::kWidth - left, 0, out), out);
  }
  int gather(std::uint32_t index, int slots, int count, std::uint32_t* out) const {
    const BinaryNode& n = tree_.nodes[index];
    int left = 0;
    if (!n.is_leaf())
      while (slots > 1 && (left = n.left_slots(slots)) == 0) --slots;
    if (n.is_leaf() || slots == 1) {
      out[count] = index;
      return count + 1;
    }
    return gather(n.link, left, gather(n.link + 1, slots - left, count, out), out);
  }

  /// Breadth first from the root until there are enough nodes; what hangs below them are the parts.
  void expand(std::vector<Entry>& top, std::vector<Entry>& parts) const {
    std::vector<Entry> queue{{0, kNoId, 0, 1}};
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const Entry e = queue[next];
      const BinaryNode& n = tree_.nodes[e.index];
      if (n.is_leaf() || top.size() >= kTopNodes) {
        parts.push_back(e);
        continue;
      }
      const auto at = static_cast<std::uint32_t>(top.size());
      top.push_back(e);
      std::uint32_t child[BvhNode::kWidth];
      const int count = children(n, child);
      for (int i = 0; i < count; ++i) queue.push_back({child[i], at, i, e.depth + 1});
    }
  }

  bool in_table(const BinaryNode& leaf) const {
    return leaf.kind() != Kind::triangle || leaf.test() != TriangleTest::watertight;
  }

  void measure(std::uint32_t index, int depth, Sizes& sizes) const {
    const BinaryNode& n = tree_.nodes[index];
    if (n.is_leaf()) {
      sizes.blocks += n.kind() == Kind::triangle;
      sizes.leaves += in_table(n);
      sizes.depth = std::max(sizes.depth, depth - 1);
      return;
    }
    ++sizes.nodes;
    std::uint32_t child[BvhNode::kWidth];
    const int count = children(n, child);
    for (int i = 0; i < count; ++i) measure(child[i], depth + 1, sizes);
  }

  NodeRef write(std::uint32_t index, Sizes& next) const {
    const BinaryNode& n = tree_.nodes[index];
    if (n.is_leaf()) return write_leaf(n, next);
    const std::uint32_t at = next.nodes++;
    std::uint32_t child[BvhNode::kWidth];
    const int count = children(n, child);
    for (int i = 0; i < count; ++i) {
      const BinaryNode& c = tree_.nodes[child[i]];
      if (c.is_leaf()) triangles_.prefetch(tree_.items + c.link, c.count());
    }
    NodeRef refs[BvhNode::kWidth];
    for (int i = 0; i < count; ++i) refs[i] = write(child[i], next);
    write_node(accel_.nodes[at], child, refs, count);
    return NodeRef::node(at);
  }

  NodeRef write_leaf(const BinaryNode& n, Sizes& next) const {
    std::uint32_t begin = n.link;
    if (n.kind() == Kind::triangle) {
      TriangleBlock& block = accel_.blocks[next.blocks];
      begin = TriangleBlock::kLeaves * next.blocks++;
      triangles_.fill(tree_.items + n.link, tree_.corners + n.link, n.count(), block);
      if (!in_table(n)) return NodeRef::triangles(begin, n.count());
    }
    accel_.leaves[next.leaves] = {begin, static_cast<std::uint16_t>(n.count()), n.kind(), n.test()};
    return NodeRef::leaf(next.leaves++, n.kind());
  }

  /// Boxes and references of `count` children.
  void write_node(BvhNode& node, const std::uint32_t* child, const NodeRef* refs, int count) const {
    for (int i = 0; i < BvhNode::kWidth; ++i) {
      const BinaryNode* c = i < count ? &tree_.nodes[child[i]] : nullptr;
      for (int axis = 0; axis < 3; ++axis) {
        node.plane[2 * axis][i] = c ? -c->negative_lo[axis] : Centers::kInf;
        node.plane[2 * axis + 1][i] = c ? c->hi[axis] : -Centers::kInf;
      }
      node.child[i] = c ? refs[i] : NodeRef::none();
    }
  }

  void set_stats(const Sizes& all) const {
    AccelStats& s = accel_.stats;
    s.nodes = all.nodes;
    s.depth = all.depth;
    s.leaves = accel_.leaves.size();
    for (const LeafEntry& l : accel_.leaves) s.leaves -= l.kind == Kind::triangle;
    s.leaves += all.blocks;
    s.node_bytes = all.nodes * sizeof(BvhNode);
    s.leaf_bytes = all.blocks * sizeof(TriangleBlock) + accel_.leaves.size() * sizeof(LeafEntry);
  }

  Accel& accel_;
  const BinaryTree& tree_;
  const TriangleSource& triangles_;
  const bool parallel_;
};

/// Gives the leaf table its ranges of the pools: until now entries of shapes other than triangles refer to
/// tree.items.
void order_pools(Accel& accel, const BinaryTree& tree, ItemOrder& order) {
  for (LeafEntry& leaf : accel.leaves) {
    if (leaf.kind == Kind::triangle) continue;
    std::vector<std::uint32_t>& list = order[static_cast<int>(leaf.kind)];
    const std::uint32_t* items = tree.items + leaf.begin;
    leaf.begin = static_cast<std::uint32_t>(list.size());
    list.insert(list.end(), items, items + leaf.count);
  }
}

}  // namespace

void build_tree(Accel& accel, const BuildArrays& arrays, const TriangleSource& triangles, ItemOrder& order,
                const BuildOptions& options, const BuildKernels& kernels, const TreePart& part) {
  if (arrays.count == 0) return;
  const BinaryTree tree = build_binary(arrays, triangles, accel.bounds, options, kernels, part);
  accel.pieces = tree.pieces;
  if (!part.reuses_arrays) arrays.discard_references();
  WideBuilder(accel, tree, triangles, options.parallel).run();
  if (options.quality == BuildQuality::compact) compact_blocks(accel, options.parallel);
  order_pools(accel, tree, order);
}

}  // namespace oktett
