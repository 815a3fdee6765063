#pragma once
/// \file Lengths and affine maps of vectors in lanes. Affine's own functions are these with one lane.

#include "core/lanes.h"
#include "core/transform.h"

namespace oktett {

template <class D>
OKTETT_INLINE D length_lanes(const Vec3<D>& v) {
  return sqrt(dot_lanes(v, v));
}

/// Unit vectors; NaN for zero vectors.
template <class D>
OKTETT_INLINE Vec3<D> unit_lanes(const Vec3<D>& v) {
  const D size = length_lanes(v);
  return {v.x / size, v.y / size, v.z / size};
}

/// a where m is set, else b.
template <class D>
OKTETT_INLINE Vec3<D> select_lanes(const typename D::M& m, const Vec3<D>& a, const Vec3<D>& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

/// Affine maps in lanes: row-major 3x4 matrices [M | t], see Affine.
template <class D>
struct AffineLanes {
  std::array<std::array<D, 4>, 3> m;
};

/// M v, for an Affine or AffineLanes.
template <class Map, class D>
OKTETT_INLINE Vec3<D> map_vector(const Map& a, const Vec3<D>& v) {
  const auto row = [&](int i) { return D(a.m[i][0]) * v.x + D(a.m[i][1]) * v.y + D(a.m[i][2]) * v.z; };
  return {row(0), row(1), row(2)};
}

/// M p + t.
template <class Map, class D>
OKTETT_INLINE Vec3<D> map_point(const Map& a, const Vec3<D>& p) {
  const Vec3<D> v = map_vector(a, p);
  return {v.x + D(a.m[0][3]), v.y + D(a.m[1][3]), v.z + D(a.m[2][3])};
}

/// M^T n: maps normals if `inverse` is the inverse of the map that moves the surface. Not normalised.
template <class Map, class D>
OKTETT_INLINE Vec3<D> map_normal(const Map& inverse, const Vec3<D>& n) {
  const auto column = [&](int i) {
    return D(inverse.m[0][i]) * n.x + D(inverse.m[1][i]) * n.y + D(inverse.m[2][i]) * n.z;
  };
  return {column(0), column(1), column(2)};
}

/// The inverse of an Affine (D = double) or of AffineLanes<D>; not finite where the map is singular.
template <class D, class Map>
OKTETT_INLINE Map inverse_map(const Map& a) {
  const auto column = [&](int j) { return Vec3<D>{a.m[0][j], a.m[1][j], a.m[2][j]}; };
  const Vec3<D> c0 = column(0), c1 = column(1), c2 = column(2), t = column(3);
  const Vec3<D> c12 = cross_lanes(c1, c2);
  const D scale = D(1.0) / dot_lanes(c0, c12);
  const Vec3<D> rows[3] = {scale_lanes(c12, scale), scale_lanes(cross_lanes(c2, c0), scale),
                           scale_lanes(cross_lanes(c0, c1), scale)};
  Map inverse;
  for (int i = 0; i < 3; ++i) inverse.m[i] = {rows[i].x, rows[i].y, rows[i].z, -dot_lanes(rows[i], t)};
  return inverse;
}

}  // namespace oktett
