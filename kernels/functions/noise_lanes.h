#pragma once
/// \file The noises of core/noise.h, of numbers with gradients, intervals, and intervals with derivatives,
/// in lanes. Each lane is computed by itself: hashing needs whole numbers of 64 bits.

#include "core/lanes.h"
#include "core/noise.h"
#include "kernels/interval/dual.h"

namespace oktett {

namespace noise_lanes {

/// The columns of lanes as an array, and back.
template <class D, int Columns>
struct Table {
  alignas(64) double at[Columns][D::kWidth];

  OKTETT_INLINE Vec3d vector(int first, int lane) const {
    return {at[first][lane], at[first + 1][lane], at[first + 2][lane]};
  }
  OKTETT_INLINE void put(int first, int lane, const Vec3d& v) {
    at[first][lane] = v.x, at[first + 1][lane] = v.y, at[first + 2][lane] = v.z;
  }
  OKTETT_INLINE D column(int k) const { return D::load(at[k]); }
  OKTETT_INLINE Vec3<D> columns(int first) const {
    return {column(first), column(first + 1), column(first + 2)};
  }
};

/// The noise at points, and its gradients.
template <class D>
OKTETT_NOINLINE void slope(const D& x, const D& y, const D& z, NoiseKind kind, D& value, Vec3<D>& gradient) {
  Table<D, 4> t;
  x.store(t.at[0]), y.store(t.at[1]), z.store(t.at[2]);
  for (int lane = 0; lane < D::kWidth; ++lane) {
    const NoiseSlope s = noise_slope(t.vector(0, lane), kind);
    t.put(0, lane, s.gradient), t.at[3][lane] = s.value;
  }
  value = t.column(3), gradient = t.columns(0);
}

/// The noise over boxes, and its derivatives. Entire or void where a side of the box is.
template <class D>
OKTETT_NOINLINE void range(const Interval<D>& x, const Interval<D>& y, const Interval<D>& z, NoiseKind kind,
                           Interval<D>& value, Interval<D> (&gradient)[3]) {
  Table<D, 8> t;
  x.lo.store(t.at[0]), y.lo.store(t.at[1]), z.lo.store(t.at[2]);
  x.hi.store(t.at[3]), y.hi.store(t.at[4]), z.hi.store(t.at[5]);
  for (int lane = 0; lane < D::kWidth; ++lane) {
    const NoiseRange r = noise_range(t.vector(0, lane), t.vector(3, lane), kind);
    t.put(0, lane, r.slope_lo), t.put(3, lane, r.slope_hi);
    t.at[6][lane] = r.lo, t.at[7][lane] = r.hi;
  }
  const auto carry = [&](const Interval<D>& r) { return interval::carry(z, interval::carry(x, y, r)); };
  value = carry({t.column(6), t.column(7)});
  for (int k = 0; k < 3; ++k) gradient[k] = carry({t.column(k), t.column(3 + k)});
}

}  // namespace noise_lanes

template <class D>
OKTETT_INLINE Interval<D> noise(const Interval<D>& x, const Interval<D>& y, const Interval<D>& z,
                                NoiseKind kind) {
  Interval<D> value, gradient[3];
  noise_lanes::range(x, y, z, kind, value, gradient);
  return value;
}
template <class D>
OKTETT_NOINLINE Dual<Interval<D>> noise(const Dual<Interval<D>>& x, const Dual<Interval<D>>& y,
                                        const Dual<Interval<D>>& z, NoiseKind kind) {
  Interval<D> value, gradient[3];
  noise_lanes::range(x.v, y.v, z.v, kind, value, gradient);
  return {value, (gradient[0] * x.d + gradient[1] * y.d) + gradient[2] * z.d};
}

}  // namespace oktett
