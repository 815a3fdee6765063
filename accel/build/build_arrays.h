#pragma once
/// \file What a build works in until the tree is written.

#include "accel/build/populate.h"
#include "accel/build/sah.h"
#include "core/soa.h"

namespace oktett {

/// A reference's cell along the space-filling curve, and its place.
struct CellKey {
  std::uint32_t cell, place;
};

/// The arrays of a build, side by side in one piece of memory. Alone, most are too small for pages of 2 MB;
/// allocating and freeing small pages would take a large part of the time of a build.
class BuildArrays {
 public:
  /// For at most `most` references and those that spatial splits add.
  BuildArrays(std::size_t most, const Effort& effort);
  BuildArrays(const BuildArrays&) = delete;
  BuildArrays& operator=(const BuildArrays&) = delete;

  // What makes the binary tree. `room` elements:
  std::size_t room;
  PrimRef *refs, *more_refs;
  std::size_t count = 0;  ///< elements of `refs` that the caller has filled in
  // One element per reference; null without Effort::cells.
  CellKey *keys, *more_keys;
  std::uint32_t* cells;

  // The binary tree. `room` items with their corners:
  std::uint32_t* items;
  std::uint16_t* corners;
  std::size_t node_room;
  BinaryNode* nodes;

  /// Allocates the pages of `size` elements from `data` on before they are written, on all threads if
  /// `parallel`. Does nothing in huge pages for arrays of at most two of them: there, the first writes
  /// allocate as cheaply.
  template <class T>
  void populate(T* data, std::size_t size, bool parallel) const {
    if (memory_.size() < kLargePiece || size * sizeof(T) > 2 * kHugePage)
      oktett::populate(data, size, parallel);
  }
  /// Gives back the memory, if it is much, of what is needed no more when the binary tree stands.
  void discard_references() const;

 private:
  Column<std::byte> memory_;
};

}  // namespace oktett
