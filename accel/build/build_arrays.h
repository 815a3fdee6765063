#pragma once
/// \file What a build works in until the tree is written.

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "accel/build/sah.h"
#include "core/pages.h"
#include "core/soa.h"

namespace oktett {

// ---- Arrays of a build that are about to be written in no particular order.

/// Has the pages of `count` elements from `data` on allocated, see populate_pages; by all threads if
/// `parallel`. Leaves small arrays alone: a call costs about as much as four page faults.
template <class T>
void populate(T* data, std::size_t count, bool parallel) {
  const std::size_t bytes = count * sizeof(T);
  if (bytes < (std::size_t{1} << 14)) return;
  // No huge page is asked for by two threads.
  const auto first = reinterpret_cast<std::uintptr_t>(data), page = first / kHugePage;
  const std::size_t pages = (first + bytes + kHugePage - 1) / kHugePage - page;
  const auto piece = [&](std::size_t i) {
    const std::uintptr_t from = std::max(first, (page + i) * kHugePage);
    const std::uintptr_t to = std::min(first + bytes, (page + i + 1) * kHugePage);
    populate_pages(reinterpret_cast<std::byte*>(data) + (from - first), to - from);
  };
  if (parallel && pages > 1)
    tbb::parallel_for(std::size_t{0}, pages, piece);
  else
    for (std::size_t i = 0; i < pages; ++i) piece(i);
}

// ---- What a build works in until the tree is written.

/// A reference's cell along the space-filling curve, and its place.
struct CellKey {
  std::uint32_t cell, place;
};

/// Room for so many references and those that spatial splits add.
inline std::size_t room_for(std::size_t references, const Effort& effort) {
  return references + static_cast<std::size_t>(effort.spatial * static_cast<double>(references));
}

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
