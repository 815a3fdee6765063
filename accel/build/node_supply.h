#pragma once
/// \file The nodes of a binary tree while it is built.

#include <atomic>
#include <utility>

#include "accel/build/populate.h"
#include "accel/build/sah.h"
#include "core/virtual_array.h"

namespace oktett {

/// Hands out nodes to threads. Pages are allocated piece by piece, shortly before they are written.
class NodeSupply {
 public:
  /// Room for `most` nodes; those that nobody takes cost no memory beyond their piece.
  explicit NodeSupply(std::size_t most) : nodes_(most), most_(most) { populate_piece(0); }

  BinaryNode& operator[](std::size_t i) { return nodes_[i]; }

  /// The first of `count` new nodes.
  std::uint32_t take(std::uint32_t count) {
    const std::uint32_t first = taken_.fetch_add(count);
    // The thread that reaches a new piece has its pages allocated.
    const std::size_t piece = (first + count) / kPiece;
    if (first / kPiece != piece) populate_piece(piece);
    return first;
  }

  /// The nodes that were taken; the supply is empty then.
  VirtualArray<BinaryNode> finish() {
    nodes_.truncate(taken_);
    return std::move(nodes_);
  }

 private:
  static constexpr std::size_t kPiece = (std::size_t{1} << 17) / sizeof(BinaryNode);

  void populate_piece(std::size_t piece) {
    const std::size_t begin = std::min(piece * kPiece, most_);
    populate(nodes_.data() + begin, std::min(kPiece, most_ - begin), false);
  }

  VirtualArray<BinaryNode> nodes_;
  const std::size_t most_;
  std::atomic<std::uint32_t> taken_{0};
};

}  // namespace oktett
