#pragma once
/// \file Tasks in parallel.

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

}  // namespace oktett
