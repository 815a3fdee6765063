#pragma once
/// \file Crossings of several rays with several solids, in columns.

#include <cstdint>

#include "core/platform.h"
#include "core/simd.h"

namespace oktett {

/// Crossings of up to W rays. Row k of a solid has the k-th crossing of each ray with it; its distance is
/// infinite for rays that have no such crossing. The rows of a solid stand together, in the order of
/// distance.
template <int W>
struct CrossingLanes {
  static constexpr int kMost = 96;  ///< rows
  static constexpr int kMostPerSolid = 4;

  alignas(64) float t[kMost][W];
  alignas(64) float turn[kMost][W];  ///< -1 enters, 1 leaves
  alignas(64) float part[kMost][W];  ///< Hit::u
  std::uint32_t item[kMost];
  bool exact[kMost];  ///< of an exact surface: Hit::v is the turn
  int rows = 0;
};

/// Appends a row with crossings in the lanes of `valid`, unless there are none.
template <int W, class A>
OKTETT_INLINE void push_row(CrossingLanes<W>& out, const Mask<float, W, A>& valid, const Simd<float, W, A>& t,
                            const Simd<float, W, A>& turn, const Simd<float, W, A>& part, std::uint32_t item,
                            bool exact) {
  if (none(valid)) return;
  using F = Simd<float, W, A>;
  const int row = out.rows++;
  select(valid, t, F(std::numeric_limits<float>::infinity())).store(out.t[row]);
  turn.store(out.turn[row]);
  part.store(out.part[row]);
  out.item[row] = item, out.exact[row] = exact;
}

}  // namespace oktett
