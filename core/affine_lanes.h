#pragma once
/// \file Lengths and affine maps of vectors in lanes: the operations of Affine in the same order.

#include "core/lanes.h"
#include "core/transform.h"

namespace oktett {

template <class D>
OKTETT_INLINE D length_lanes(const Vec3<D>& v) {
  return sqrt(dot_lanes(v, v));
}

/// a where m is set, else b.
template <class D>
OKTETT_INLINE Vec3<D> select_lanes(const typename D::M& m, const Vec3<D>& a, const Vec3<D>& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

/// Affine::vector.
template <class D>
OKTETT_INLINE Vec3<D> map_vector(const Affine& a, const Vec3<D>& v) {
  const auto row = [&](int i) { return D(a.m[i][0]) * v.x + D(a.m[i][1]) * v.y + D(a.m[i][2]) * v.z; };
  return {row(0), row(1), row(2)};
}

/// Affine::point.
template <class D>
OKTETT_INLINE Vec3<D> map_point(const Affine& a, const Vec3<D>& p) {
  const Vec3<D> v = map_vector(a, p);
  return {v.x + D(a.m[0][3]), v.y + D(a.m[1][3]), v.z + D(a.m[2][3])};
}

/// Affine::normal_by_inverse.
template <class D>
OKTETT_INLINE Vec3<D> map_normal(const Affine& inverse, const Vec3<D>& n) {
  const auto column = [&](int i) {
    return D(inverse.m[0][i]) * n.x + D(inverse.m[1][i]) * n.y + D(inverse.m[2][i]) * n.z;
  };
  return {column(0), column(1), column(2)};
}

}  // namespace oktett
