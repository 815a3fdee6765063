#include "accel/build/tree_store.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <span>

#include "core/bytes.h"

namespace oktett {
namespace {

std::atomic<TreeStore*> current_store{nullptr};

template <class T>
std::uint64_t column_checksum(const Column<T>& column) {
  return block_checksum(column.data(), column.size() * sizeof(T));
}

/// Checks nodes and leaves. Each node, leaf of triangles and entry of the leaf table must be the child of
/// exactly one node that stands before it, as the builder writes them. So no ray goes round in circles or
/// takes more steps than there are nodes.
class LinkCheck {
 public:
  LinkCheck(const Accel& accel, const ItemOrder& order)
      : accel_(accel),
        order_(order),
        depth_(accel.stats.nodes),
        triangles_seen_(TriangleBlock::kLeaves * block_count(accel)),
        leaf_seen_(accel.leaves.size()) {}

  bool run(int& depth) {
    depth = 0;
    if (!visit(accel_.root, 0, 1)) return false;
    for (std::uint32_t n = 0; n < accel_.stats.nodes; ++n) {
      if (depth_[n] == 0 || depth_[n] > kMaxDepth) return false;
      depth = std::max<int>(depth, depth_[n]);
      for (const NodeRef child : accel_.nodes[n].child)
        if (!visit(child, n + 1, depth_[n] + 1)) return false;
    }
    const auto all = [](const std::vector<bool>& seen) {
      return std::ranges::find(seen, false) == seen.end();
    };
    // Plain blocks have no second leaf.
    for (std::size_t b = 0; b < block_count(accel_); ++b)
      if (!accel_.blocks[b].is_packed() && !take(triangles_seen_, TriangleBlock::kLeaves * b + 1))
        return false;
    return all(triangles_seen_) && all(leaf_seen_);
  }

 private:
  /// A child of a node at depth `depth` - 1. Nodes must have a number of at least `least`.
  bool visit(NodeRef ref, std::uint32_t least, int depth) {
    if (ref.is_none()) return true;
    if (!ref.is_leaf()) {
      const std::uint32_t n = ref.node_index();
      if (n < least || n >= depth_.size() || depth_[n] != 0) return false;
      depth_[n] = static_cast<std::uint8_t>(std::min(depth, kMaxDepth + 1));
      return true;
    }
    if (ref.is_triangles()) return take(triangles_seen_, ref.triangle_leaf());
    if (!take(leaf_seen_, ref.table_index())) return false;
    const LeafEntry& leaf = accel_.leaves[ref.table_index()];
    return is_possible(leaf) && ref.is_spheres() == (leaf.kind == Kind::sphere);
  }

  bool is_possible(const LeafEntry& leaf) {
    if (static_cast<int>(leaf.kind) >= kKinds || leaf.count == 0 || leaf.count > TriangleBlock::kSize)
      return false;
    if (leaf.kind != Kind::triangle)
      return std::uint64_t{leaf.begin} + leaf.count <= order_[static_cast<int>(leaf.kind)].size();
    return leaf.test <= TriangleTest::segura_feito && take(triangles_seen_, leaf.begin);
  }

  static bool take(std::vector<bool>& seen, std::size_t index) {
    if (index >= seen.size() || seen[index]) return false;
    seen[index] = true;
    return true;
  }

  const Accel& accel_;
  const ItemOrder& order_;
  std::vector<std::uint8_t> depth_;  ///< per node; 0: no parent has been found yet
  std::vector<bool> triangles_seen_, leaf_seen_;
};

/// Every lane of a leaf holds a triangle of some mesh, or nothing that a ray could hit.
bool is_possible(const TriangleLeaf& leaf, const Accel& accel) {
  std::uint32_t first = 1, end = 0;
  const bool is_packed = leaf.block().is_packed();
  for (int lane = 0; lane < TriangleBlock::kSize; ++lane) {
    if (((leaf.corners()[lane] & TriangleBlock::kPacked) != 0) != is_packed) return false;
    const std::uint32_t item = leaf.item(lane);
    if (item == kNoId) {
      const int corner = leaf.corner(0, lane);
      if (leaf.corner(1, lane) != corner || leaf.corner(2, lane) != corner) return false;
      continue;
    }
    if (item >= first && item < end) continue;
    if (item >= accel.stats.items) return false;
    const std::uint32_t geometry = accel.geometry_of(item);
    if (static_cast<Kind>(accel.kinds[geometry]) != Kind::triangle) return false;
    first = accel.first_item[geometry], end = accel.first_item[geometry + 1];
  }
  return true;
}

/// The same for all leaves of block `b`.
bool are_possible(const Accel& accel, std::size_t b) {
  const auto first = static_cast<std::uint32_t>(TriangleBlock::kLeaves * b);
  return is_possible(accel.triangles(first), accel) &&
         (!accel.blocks[b].is_packed() || is_possible(accel.triangles(first + 1), accel));
}

bool blocks_are_possible(const Accel& accel) {
  using Blocks = tbb::blocked_range<std::size_t>;
  return tbb::parallel_reduce(
      Blocks(0, block_count(accel), 4096), true,
      [&](const Blocks& range, bool good) {
        for (std::size_t i = range.begin(); good && i < range.end(); ++i) good = are_possible(accel, i);
        return good;
      },
      [](bool a, bool b) { return a && b; });
}

/// Why a tree that was loaded cannot belong to the geometries of `accel`; empty if it can. `unbounded` and
/// `others` are all items but the triangles. Sets accel.stats.depth.
std::string why_no_tree(Accel& accel, const ItemOrder& order, const ItemOrder& unbounded,
                        const Column<PrimRef>& others) {
  std::vector<std::uint32_t> expected[kKinds];
  for (const PrimRef& ref : others) expected[ref.kind & 0xffu].push_back(ref.item);
  for (int kind = 0; kind < kKinds; ++kind) {
    // The unbounded items stand first, in the order in which `accel.unbounded` refers to them.
    const std::vector<std::uint32_t>&all = order[kind], &first = unbounded[kind];
    if (all.size() != first.size() + expected[kind].size() ||
        !std::ranges::equal(first, std::span(all).first(first.size())))
      return "it has other items";
    std::vector<std::uint32_t> rest(all.begin() + static_cast<std::ptrdiff_t>(first.size()), all.end());
    std::ranges::sort(rest), std::ranges::sort(expected[kind]);
    if (rest != expected[kind]) return "it has other items";
  }
  if (!accel.bounds.empty() && !(is_finite(accel.bounds.lo) && is_finite(accel.bounds.hi)))
    return "its bounds are not finite";
  if (!LinkCheck(accel, order).run(accel.stats.depth)) return "its nodes do not make a tree";
  return blocks_are_possible(accel) ? "" : "its triangles are of another scene";
}

}  // namespace

void set_tree_store(TreeStore* store) { current_store = store; }
TreeStore* tree_store() { return current_store; }

std::uint64_t tree_key(const Accel& accel, const Column<PrimRef>& others, const BuildOptions& options) {
  Hasher hash;
  hash.add(static_cast<std::uint64_t>(options.quality));
  for (std::size_t g = 0; g < accel.geometries.size(); ++g) {
    const Geometry& geometry = accel.geometries[g];
    hash.add(std::uint64_t{accel.first_item[g]});
    hash.add(std::uint64_t{accel.kinds[g]});
    const auto* shape = std::get_if<MeshGeometry>(&geometry.shape);
    if (shape == nullptr) continue;
    hash.add(column_checksum(shape->mesh->positions));
    hash.add(column_checksum(shape->mesh->indices));
    hash.add(static_cast<std::uint64_t>(shape->test));
    for (const auto& row : geometry.transform.m)
      for (const double x : row) hash.add(x);
  }
  hash.add(column_checksum(others));
  return hash.value();
}

std::size_t block_count(const Accel& accel) {
  return (accel.stats.leaf_bytes - accel.leaves.size() * sizeof(LeafEntry)) / sizeof(TriangleBlock);
}

void count_tree(Accel& accel, std::size_t nodes, std::size_t blocks) {
  AccelStats& s = accel.stats;
  s.nodes = nodes;
  s.leaves = accel.leaves.size() + blocks;
  for (std::size_t b = 0; b < blocks; ++b) s.leaves += accel.blocks[b].is_packed();
  for (const LeafEntry& l : accel.leaves) s.leaves -= l.kind == Kind::triangle;
  s.node_bytes = nodes * sizeof(BvhNode);
  s.leaf_bytes = blocks * sizeof(TriangleBlock) + accel.leaves.size() * sizeof(LeafEntry);
}

bool load_kept_tree(Accel& accel, ItemOrder& order, const Column<PrimRef>& others, std::uint64_t key,
                    TreeStore& store) {
  const Box bounds = accel.bounds;
  const AccelStats stats = accel.stats;
  ItemOrder kept;
  if (store.load(key, accel, kept)) {
    const std::string why = why_no_tree(accel, kept, order, others);
    if (why.empty()) {
      std::ranges::move(kept, order);
      return true;
    }
    store.refuse(key, why);
  }
  accel.nodes = {}, accel.blocks = {}, accel.leaves.clear();
  accel.root = NodeRef::none();
  accel.bounds = bounds, accel.stats = stats, accel.pieces = false;
  return false;
}

}  // namespace oktett
