#pragma once
/// \file The nodes of a binary tree while it is built.

#include <algorithm>
#include <atomic>

#include "accel/build/build_arrays.h"

namespace oktett {

/// Hands out the nodes of a build to threads. Their pages are allocated piece by piece, shortly before they
/// are written.
class NodeSupply {
 public:
  explicit NodeSupply(const BuildArrays& arrays) : arrays_(arrays) { populate_piece(0); }

  BinaryNode& operator[](std::size_t i) const { return arrays_.nodes[i]; }

  /// The first of `count` new nodes.
  std::uint32_t take(std::uint32_t count) {
    const std::uint32_t first = taken_.fetch_add(count);
    // The thread that reaches a new piece has its pages allocated.
    const std::size_t piece = (first + count) / kPiece;
    if (first / kPiece != piece) populate_piece(piece);
    return first;
  }

 private:
  static constexpr std::size_t kPiece = (std::size_t{1} << 17) / sizeof(BinaryNode);

  void populate_piece(std::size_t piece) const {
    const std::size_t begin = std::min(piece * kPiece, arrays_.node_room);
    arrays_.populate(arrays_.nodes + begin, std::min(kPiece, arrays_.node_room - begin), false);
  }

  const BuildArrays& arrays_;
  std::atomic<std::uint32_t> taken_{0};
};

}  // namespace oktett
