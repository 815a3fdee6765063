#pragma once
/// \file Ranges that are cut into chunks for threads.

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

namespace oktett {

/// The cut depends on the number of elements alone, so what is computed chunk by chunk is the same for any
/// number of threads. in_parts (core/parallel.h) leaves the cut to the scheduler.
struct Chunks {
  std::size_t total, size, count;

  /// Chunks of `elements` each, the last one of what remains.
  Chunks(std::size_t range, std::size_t elements)
      : total(range), size(elements), count((range + elements - 1) / elements) {}
  /// At most `most` chunks, each of at least `least` elements except for the last.
  Chunks(std::size_t range, std::size_t least, std::size_t most)
      : Chunks(range, std::max(least, (range + most - 1) / most)) {}

  /// Calls body(c, begin, end) for the elements [begin, end) of each chunk c, on all threads if `parallel`.
  template <class Body>
  void each(bool parallel, Body&& body) const {
    const auto chunk = [&](std::size_t c) { body(c, c * size, std::min((c + 1) * size, total)); };
    if (parallel && count > 1)
      tbb::parallel_for(std::size_t{0}, count, chunk);
    else
      for (std::size_t c = 0; c < count; ++c) chunk(c);
  }
};

}  // namespace oktett
