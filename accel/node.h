#pragma once
/// \file The nodes and leaves of the tree in memory.

#include <cstdint>

#include "kernels/closed/shape_data.h"
#include "kernels/kinds.h"

namespace oktett {

/// The number of a child: of a node, of a leaf of triangles, or of an entry in the leaf table. Leaves of
/// triangles are by far the most frequent, so they need no table.
class NodeRef {
 public:
  static constexpr std::uint32_t kMaxTriangleLeaves = 1u << 27;

  NodeRef() = default;
  static NodeRef node(std::uint32_t index) { return NodeRef(index); }
  /// A TriangleLeaf of `count` triangles, 1 to 8, tested by the watertight test.
  static NodeRef triangles(std::uint32_t leaf, int count) {
    return NodeRef(kLeaf | static_cast<std::uint32_t>(count - 1) << 27 | leaf);
  }
  /// An entry of the leaf table. Whether it is one of spheres shows in the number, so that rays in flight
  /// need not look it up to know.
  static NodeRef leaf(std::uint32_t table_index, Kind kind) {
    return NodeRef(kLeaf | kTable | (kind == Kind::sphere ? 0 : kNoSpheres) | table_index);
  }
  static NodeRef none() { return NodeRef(~0u); }
  /// Only on the stack of a ray in flight: here the ray leaves the instance that it is in.
  static NodeRef way_out() { return NodeRef(~1u); }

  bool is_leaf() const { return (bits_ & kLeaf) != 0; }
  bool is_triangles() const { return (bits_ & (kLeaf | kTable)) == kLeaf; }
  bool is_spheres() const { return (bits_ & (kLeaf | kTable | kNoSpheres)) == (kLeaf | kTable); }
  bool is_none() const { return bits_ == none().bits_; }
  bool is_way_out() const { return bits_ == way_out().bits_; }
  std::uint32_t node_index() const { return bits_; }
  /// The number of a TriangleLeaf.
  std::uint32_t triangle_leaf() const { return bits_ & (kMaxTriangleLeaves - 1); }
  int triangle_count() const { return static_cast<int>(bits_ >> 27 & 7) + 1; }
  std::uint32_t table_index() const { return bits_ & (kNoSpheres - 1); }
  /// The number as it is stored: nodes from 0 on, leaves of triangles from 2^31 on, table entries of spheres
  /// from 3 * 2^30 on, those of other kinds from 7 * 2^29 on.
  std::uint32_t bits() const { return bits_; }
  static NodeRef from_bits(std::uint32_t bits) { return NodeRef(bits); }

 private:
  explicit NodeRef(std::uint32_t bits) : bits_(bits) {}
  static constexpr std::uint32_t kLeaf = 1u << 31, kTable = 1u << 30, kNoSpheres = 1u << 29;
  std::uint32_t bits_;
};

/// Eight children and their boxes in columns: 256 bytes. `plane[2 * axis + side]`, side 0 = low, 1 = high.
/// Unused children have empty boxes (low = +inf, high = -inf), which no ray meets.
struct alignas(64) BvhNode {
  static constexpr int kWidth = 8;
  float plane[6][kWidth];
  NodeRef child[kWidth];
  std::uint32_t padding[8];

  /// The children as NodeRef::bits.
  const std::uint32_t* child_bits() const { return reinterpret_cast<const std::uint32_t*>(child); }
};
static_assert(sizeof(BvhNode) == 256);

/// A leaf that is not one of watertight triangles: `count` items of one kind from `begin` in the kind's pool
/// (for triangles: TriangleLeaf number `begin`, tested as `test` says).
struct LeafEntry {
  std::uint32_t begin = 0;
  std::uint16_t count = 0;
  Kind kind = Kind::triangle;
  TriangleTest test = TriangleTest::watertight;
};
static_assert(sizeof(LeafEntry) == 8);

/// The builder makes no deeper tree, so a stack of (kWidth - 1) * kMaxDepth + 1 entries suffices.
inline constexpr int kMaxDepth = 64;
inline constexpr int kStackSize = (BvhNode::kWidth - 1) * kMaxDepth + 1;

}  // namespace oktett
