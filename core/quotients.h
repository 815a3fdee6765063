#pragma once
/// \file Vectors divided by their lengths, for results that are rounded to float.

#include "core/lanes.h"

namespace oktett {

/// v / size, computed in double and rounded to float: the bits of three quotients for the price of one.
///
/// With u = 2^-53, x times the inverse of `size` is off by at most 2u, the quotient itself by u, and the
/// products by 1 - 8u and 1 + 8u by u more. So these products enclose the quotient, and rounding is monotone:
/// where both round to the same float, so does the quotient. Elsewhere it is computed.
template <int W, class A>
OKTETT_INLINE Vec3<Simd<float, W, A>> float_quotients(const Vec3<Simd<double, W, A>>& v,
                                                      const Simd<double, W, A>& size) {
  using D = Simd<double, W, A>;
  using F = Simd<float, W, A>;
  if constexpr (W > 1) {
    const D inverse = D(1.0) / size;
    // Beyond these an inverse may have overflowed or lost digits.
    auto sure = mask_cast<float>((D(1e-300) < inverse) & (inverse < D(1e300)));
    const auto quotient = [&](const D& x) {
      const D near = x * inverse;
      const F low = to_float(near * D(1 - 0x1p-50)), high = to_float(near * D(1 + 0x1p-50));
      sure = sure & (low == high);
      return low;
    };
    const Vec3<F> quotients{quotient(v.x), quotient(v.y), quotient(v.z)};
    if (none(~sure)) return quotients;
  }
  return to_float(Vec3<D>{v.x / size, v.y / size, v.z / size});
}

}  // namespace oktett
