#pragma once
/// \file Prefetching what a ray visits next.

#include <algorithm>
#include <cmath>

#include "accel/accel_data.h"
#include "core/ray.h"

namespace oktett {

/// Trees above this size are prefetched; smaller ones are in the caches, where a prefetch costs more than it
/// saves. For rays that begin far from each other the limit is about the size of a core's own cache.
inline constexpr std::size_t kPrefetchBytes = std::size_t{32} << 20,
                             kPrefetchScatteredBytes = std::size_t{2} << 20;

inline std::size_t tree_bytes(const Accel& accel) { return accel.stats.node_bytes + accel.stats.leaf_bytes; }

/// Whether most rays begin farther from the ray before them than a 16th of the scene's longest edge. Looks at
/// 16 pairs of rays at most.
inline bool are_scattered(const RaySpan& rays, const Box& bounds) {
  constexpr std::size_t kPairs = 16;
  if (rays.size < 2 || bounds.empty()) return false;
  const float far = max_component(bounds.hi - bounds.lo) / 16;
  const std::size_t pairs = std::min(kPairs, rays.size - 1);
  std::size_t scattered = 0;
  for (std::size_t n = 0; n < pairs; ++n) {
    const std::size_t i = n * (rays.size - 1) / pairs;
    float most = 0;
    for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(rays.origin[k][i + 1] - rays.origin[k][i]));
    scattered += most > far;
  }
  return 2 * scattered > pairs;
}

/// Whether rays in flight through a tree without instances prefetch it.
inline bool pays_to_prefetch(const Accel& accel, const RaySpan& rays) {
  const std::size_t bytes = tree_bytes(accel);
  return bytes > kPrefetchBytes || (bytes > kPrefetchScatteredBytes && are_scattered(rays, accel.bounds));
}

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
    static_assert(sizeof(TriangleBlock) == sizeof(BvhNode));
    const std::uintptr_t at =
        reinterpret_cast<std::uintptr_t>(of[ref.bits() >> 31]) + ref.block() * sizeof(BvhNode);
    for (std::size_t line = 0; line < sizeof(BvhNode); line += 64)
      __builtin_prefetch(reinterpret_cast<const void*>(at + line));
  }
};

}  // namespace oktett
