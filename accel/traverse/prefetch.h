#pragma once
/// \file Prefetching what a ray visits next.

#include "accel/accel_data.h"

namespace oktett {

/// Trees above this size are prefetched; smaller ones are in the caches, where a prefetch costs more than it
/// saves.
inline constexpr std::size_t kPrefetchBytes = std::size_t{32} << 20;

inline std::size_t tree_bytes(const Accel& accel) { return accel.stats.node_bytes + accel.stats.leaf_bytes; }

/// Where the nodes and the blocks of triangles of a structure begin, as bytes.
struct TreeBytes {
  const char* of[2];
  TreeBytes() = default;
  explicit TreeBytes(const Accel& accel)
      : of{reinterpret_cast<const char*>(accel.nodes.data()),
           reinterpret_cast<const char*>(accel.blocks.data())} {}

  OKTETT_INLINE const BvhNode* nodes() const { return reinterpret_cast<const BvhNode*>(of[0]); }
  OKTETT_INLINE const TriangleBlock* blocks() const { return reinterpret_cast<const TriangleBlock*>(of[1]); }

  /// Prefetches a node or a block. For any other leaf the address means nothing, so it is a number here: a
  /// pointer may not leave its array.
  OKTETT_INLINE void prefetch(NodeRef ref) const {
    const std::uint32_t is_leaf = ref.bits() >> 31;
    const std::size_t index = ref.block();
    const std::uintptr_t at =
        reinterpret_cast<std::uintptr_t>(of[is_leaf]) + index * sizeof(BvhNode) +
        (index & (0 - std::size_t{is_leaf})) * (sizeof(TriangleBlock) - sizeof(BvhNode));
    for (std::size_t line = 0; line < sizeof(TriangleBlock); line += 64)
      __builtin_prefetch(
          reinterpret_cast<const void*>(at + (line < sizeof(BvhNode) ? line : is_leaf * line)));
  }
};

}  // namespace oktett
