#pragma once
/// \file A node of 96 bytes instead of 256: its children's boxes in steps of a grid (compressed wide nodes:
/// Ylitie, Karras and Laine 2017, section 3.1; here with room for any reference, and boxes that are checked
/// when they are made).

#include <bit>
#include <cstdint>

#include "accel/node.h"
#include "core/box.h"
#include "core/platform.h"

namespace oktett {

/// Up to eight children: plane q of an axis stands at origin + q * scale, the product exact, the sum rounded
/// once, and scale a power of two. A decoded box holds the child's whole box, rounding included, so rays that
/// meet the one meet the other. Children fill the first places; what the planes of the others say is
/// meaningless, and `present` leaves them out. 96 bytes, of which every node touches two cache lines.
struct alignas(32) CompactNode {
  static constexpr int kWidth = BvhNode::kWidth;
  float origin[3];
  std::uint8_t exponent[3];  ///< scale = 2^(exponent - 127); 0: scale 0, an axis along which all is flat
  std::uint8_t present;      ///< bit i: there is a child i
  NodeRef child[kWidth];
  std::uint8_t plane[6][kWidth];  ///< `plane[2 * axis + side]` as in BvhNode

  OKTETT_INLINE float scale(int axis) const {
    return std::bit_cast<float>(std::uint32_t{exponent[axis]} << 23);
  }
  /// The children as NodeRef::bits.
  const std::uint32_t* child_bits() const { return reinterpret_cast<const std::uint32_t*>(child); }
};
static_assert(sizeof(CompactNode) == 96);

/// Writes the boxes of `count` (1 to 8) children into `node`; they must be finite and not empty. Any finite
/// extents will do: where not even 255 steps of the greatest scale reach, high planes become infinite.
void set_boxes(CompactNode& node, const Box* boxes, int count);

/// A plane of one child, as traversals see it.
OKTETT_INLINE float node_plane(const BvhNode& node, int row, int child) { return node.plane[row][child]; }
OKTETT_INLINE float node_plane(const CompactNode& node, int row, int child) {
  return node.origin[row / 2] + static_cast<float>(node.plane[row][child]) * node.scale(row / 2);
}

/// The children that there are, as bits. Those that BvhNode does not have are met by no ray.
OKTETT_INLINE unsigned present_children(const BvhNode&) { return (1u << BvhNode::kWidth) - 1; }
OKTETT_INLINE unsigned present_children(const CompactNode& node) { return node.present; }

}  // namespace oktett
