#pragma once
/// \file Quick reciprocals for filters.

#include "core/simd.h"

namespace oktett {

/// 1 / x with a relative error of at most 2^-21: an estimate of the processor (at most 1.5 * 2^-12 off) and a
/// step of Newton's method. Where x or 1 / x is zero, infinite or denormal the result may be any
/// number. The bits differ between instruction sets.
template <int W, class A>
OKTETT_INLINE Simd<float, W, A> fast_reciprocal(const Simd<float, W, A>& x) {
  if constexpr (W == 1 || std::is_same_v<A, ScalarIsa>) {
    return Simd<float, W, A>(1.0f) / x;
  } else {
    Simd<float, W, A> r;
    for (int i = 0; i < r.kParts; ++i) r.part[i] = native::estimate_reciprocal(x.part[i]);
    return r * (Simd<float, W, A>(2.0f) - x * r);
  }
}

}  // namespace oktett
