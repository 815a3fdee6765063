#pragma once
/// \file Columns of any length into lanes.

#include <cstddef>

#include "core/simd.h"

namespace oktett {

/// `T` columns at position b, lanes past the end repeating the last element.
template <class V, class T>
OKTETT_INLINE V load_column(const T* column, std::size_t b, std::size_t count) {
  constexpr int W = V::kWidth;
  if (OKTETT_LIKELY(b + W <= count)) return V::load(column + b);
  T tail[W];
  for (int i = 0; i < W; ++i) tail[i] = column[b + i < count ? b + i : count - 1];
  return V::load(tail);
}

}  // namespace oktett
