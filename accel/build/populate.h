#pragma once
/// \file Arrays of a build that are about to be written in no particular order.

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

#include "core/populate.h"

namespace oktett {

/// Has the pages of `count` elements from `data` on allocated, see populate_pages; by all threads if
/// `parallel`. Leaves small arrays alone: a call costs about as much as four page faults.
template <class T>
void populate(T* data, std::size_t count, bool parallel) {
  if (count * sizeof(T) < (std::size_t{1} << 14)) return;
  constexpr std::size_t kPiece = (std::size_t{1} << 19) / sizeof(T) + 1;
  const std::size_t pieces = (count + kPiece - 1) / kPiece;
  const auto piece = [&](std::size_t i) {
    populate_pages(data + i * kPiece, std::min(kPiece, count - i * kPiece) * sizeof(T));
  };
  if (parallel && pieces > 1)
    tbb::parallel_for(std::size_t{0}, pieces, piece);
  else
    for (std::size_t i = 0; i < pieces; ++i) piece(i);
}

}  // namespace oktett
