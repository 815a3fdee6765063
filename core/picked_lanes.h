#pragma once
/// \file Lanes that are loaded from any entries of columns, and stored there.

#include <cstdint>

#include "core/simd.h"

namespace oktett {

/// Entries index[0], index[1], ... of columns of floats, one for each lane of F. If they are consecutive,
/// they are loaded and stored at once.
template <class F>
class PickedLanes {
 public:
  explicit OKTETT_INLINE PickedLanes(const std::uint32_t* index) : index_(index) {
    for (int k = 1; k < F::kWidth; ++k) neighbours_ &= index[k] == index[0] + static_cast<std::uint32_t>(k);
  }
  OKTETT_INLINE F load(const float* column) const {
    if (neighbours_) return F::load(column + index_[0]);
    float lanes[F::kWidth];
    for (int k = 0; k < F::kWidth; ++k) lanes[k] = column[index_[k]];
    return F::load(lanes);
  }
  /// Lanes of the same entry must hold the same number.
  OKTETT_INLINE void store(const F& x, float* column) const {
    if (neighbours_) return x.store(column + index_[0]);
    float lanes[F::kWidth];
    x.store(lanes);
    for (int k = 0; k < F::kWidth; ++k) column[index_[k]] = lanes[k];
  }
  /// Adds to the entries of the lanes in `where`, one after the other if they are the same. All lanes must
  /// have an entry.
  OKTETT_INLINE void add(const F& x, float* column, unsigned where) const {
    if (neighbours_) {
      const F old = F::load(column + index_[0]);
      return select(F::M::from_bits(where), old + x, old).store(column + index_[0]);
    }
    float lanes[F::kWidth];
    x.store(lanes);
    for (; where != 0; where &= where - 1) {
      const int k = __builtin_ctz(where);
      column[index_[k]] += lanes[k];
    }
  }

 private:
  const std::uint32_t* index_;
  bool neighbours_ = true;
};

}  // namespace oktett
