#pragma once
/// \file Two tasks in parallel.

#include <tbb/parallel_invoke.h>

#include <utility>

namespace oktett {

/// Calls f() and g(), in parallel if a thread is free.
template <class F, class G>
void run_both(F&& f, G&& g) {
  tbb::parallel_invoke(std::forward<F>(f), std::forward<G>(g));
}

}  // namespace oktett
