#pragma once
/// \file Work that may be done at the same time.

#include <tbb/parallel_invoke.h>

#include <utility>

namespace oktett {

/// Calls f() and g(), if a thread is free at the same time.
template <class F, class G>
void run_both(F&& f, G&& g) {
  tbb::parallel_invoke(std::forward<F>(f), std::forward<G>(g));
}

}  // namespace oktett
