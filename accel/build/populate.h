#pragma once
/// \file Arrays of a build that are about to be written in no particular order.

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/pages.h"

namespace oktett {

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
}  // namespace oktett
