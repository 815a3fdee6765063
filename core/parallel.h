#pragma once
/// \file Tasks in parallel, and ranges that are cut for them.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/soa.h"

namespace oktett {

/// Calls f() and g(), in parallel if a thread is free.
template <class F, class G>
void run_both(F&& f, G&& g) {
  tbb::parallel_invoke(std::forward<F>(f), std::forward<G>(g));
}

/// Calls f(begin, end) for parts of 0 to `size`, in parallel if there are more than `part` numbers.
template <class F>
void in_parts(std::size_t size, std::size_t part, F&& f) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size, part),
                    [&](const tbb::blocked_range<std::size_t>& range) { f(range.begin(), range.end()); });
}

/// Calls f(i) for all i below `count`, many of them at the same time: for short work on large arrays.
template <class F>
void for_all(std::size_t count, F&& f) {
  in_parts(count, std::size_t{1} << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) f(i);
  });
}

/// A column of `size` elements that equal `value`. All threads write it: the system clears the pages of new
/// memory when they are first written, which takes longer than the writing.
template <class T>
Column<T> filled_column(std::size_t size, T value) {
  Column<T> column(size);
  in_parts(size, std::size_t{1} << 18, [&](std::size_t begin, std::size_t end) {
    std::fill(column.begin() + begin, column.begin() + end, value);
  });
  return column;
}

/// The cut depends on the number of elements alone, so what is computed chunk by chunk is the same for any
/// number of threads. in_parts leaves the cut to the scheduler.
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
