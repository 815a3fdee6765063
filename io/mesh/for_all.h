#pragma once
/// \file A loop over the elements of large meshes on all cores. Within io/ only.

#include <cstddef>

#include "core/parallel.h"

namespace oktett {

/// Calls f(i) for all i below `count`, many of them at the same time.
template <class F>
void for_all(std::size_t count, const F& f) {
  in_parts(count, std::size_t{1} << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) f(i);
  });
}

}  // namespace oktett
