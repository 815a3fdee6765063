#pragma once
/// \file Rays, hits, vectors and affine maps in lanes. The functions of Affine are these with one lane.
///
/// A kernel pairs lane i of the rays with lane i of the shapes. Either side may be one element broadcast to
/// all lanes, so one kernel tests a packet against one shape and one ray against several shapes.

#include "core/simd.h"
#include "core/transform.h"
#include "core/vec3.h"

namespace oktett {

/// Rays in lanes of F, a Simd of float or double. A hit counts if tmin < t <= tmax.
template <class F>
struct RayLanes {
  Vec3<F> o, d;
  F tmin, tmax;
};

/// Rays whose lanes `load` makes of columns: three each of `o` and `d`, one each of `tmin` and `tmax`.
template <class Load, class Columns, class Column>
OKTETT_INLINE auto load_ray_lanes(const Load& load, const Columns& o, const Columns& d, const Column& tmin,
                                  const Column& tmax) {
  return RayLanes<decltype(load(tmin))>{
      {load(o[0]), load(o[1]), load(o[2])}, {load(d[0]), load(d[1]), load(d[2])}, load(tmin), load(tmax)};
}

/// What a kernel finds in each lane; defined only where the returned mask is set.
template <class F>
struct HitLanes {
  F t, u, v;
};

/// Calls take(lane, t, u, v) for each of `lanes`, which hold hits.
template <class F, class Take>
OKTETT_INLINE void each_hit(unsigned lanes, const HitLanes<F>& hits, Take&& take) {
  if (lanes == 0) return;
  alignas(64) float t[F::kWidth], u[F::kWidth], v[F::kWidth];
  hits.t.store(t), hits.u.store(u), hits.v.store(v);
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    take(i, t[i], u[i], v[i]);
  }
}

template <int W, class A>
OKTETT_INLINE Vec3<Simd<double, W, A>> to_double(const Vec3<Simd<float, W, A>>& v) {
  return {to_double(v.x), to_double(v.y), to_double(v.z)};
}

/// Each component rounded to the nearest float.
template <int W, class A>
OKTETT_INLINE Vec3<Simd<float, W, A>> to_float(const Vec3<Simd<double, W, A>>& v) {
  return {to_float(v.x), to_float(v.y), to_float(v.z)};
}

/// The same rays in double, exactly.
template <int W, class A>
OKTETT_INLINE RayLanes<Simd<double, W, A>> to_double(const RayLanes<Simd<float, W, A>>& r) {
  return {to_double(r.o), to_double(r.d), to_double(r.tmin), to_double(r.tmax)};
}

/// One vector in all lanes.
template <class F, class T>
OKTETT_INLINE Vec3<F> broadcast(const Vec3<T>& v) {
  return {F(static_cast<typename F::Element>(v.x)), F(static_cast<typename F::Element>(v.y)),
          F(static_cast<typename F::Element>(v.z))};
}

/// The number in a vector of one lane.
template <class T, class A>
OKTETT_INLINE T only_lane(const Simd<T, 1, A>& x) {
  return x.part[0].v;
}
/// Vectors of one lane as plain vectors.
template <class T, class A>
OKTETT_INLINE Vec3<T> only_lane(const Vec3<Simd<T, 1, A>>& v) {
  return {only_lane(v.x), only_lane(v.y), only_lane(v.z)};
}

/// dot, cross and so on with a fixed order of operations and no fusing: the same bits in every width and
/// instruction set.
template <class F>
OKTETT_INLINE F dot_lanes(const Vec3<F>& a, const Vec3<F>& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
template <class F>
OKTETT_INLINE Vec3<F> cross_lanes(const Vec3<F>& a, const Vec3<F>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class F>
OKTETT_INLINE Vec3<F> sub_lanes(const Vec3<F>& a, const Vec3<F>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class F>
OKTETT_INLINE Vec3<F> add_lanes(const Vec3<F>& a, const Vec3<F>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class F>
OKTETT_INLINE Vec3<F> scale_lanes(const Vec3<F>& a, const F& s) {
  return {a.x * s, a.y * s, a.z * s};
}

/// dot and cross for filters, where any rounding will do.
template <class F>
OKTETT_INLINE F fast_dot(const Vec3<F>& a, const Vec3<F>& b) {
  return fast_fma(a.x, b.x, fast_fma(a.y, b.y, a.z * b.z));
}
template <class F>
OKTETT_INLINE Vec3<F> fast_cross(const Vec3<F>& a, const Vec3<F>& b) {
  return {fast_fms(a.y, b.z, a.z * b.y), fast_fms(a.z, b.x, a.x * b.z), fast_fms(a.x, b.y, a.y * b.x)};
}
/// |x| + |y| + |z|.
template <class F>
OKTETT_INLINE F norm1(const Vec3<F>& a) {
  return abs(a.x) + abs(a.y) + abs(a.z);
}

/// `x` within [least, most]; `least` for NaN.
template <class D>
OKTETT_INLINE D within(const D& x, const D& least, const D& most) {
  return min(max(x, least), most);
}

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

/// make_basis in lanes. At n.z = -0 the sign is 1.
template <class D>
OKTETT_INLINE void basis_lanes(const Vec3<D>& n, Vec3<D>& tangent, Vec3<D>& bitangent) {
  const D one(1), sign = select(n.z < D(0), -one, one);
  const D a = -one / (sign + n.z), b = n.x * n.y * a;
  tangent = {one + sign * n.x * n.x * a, sign * b, -sign * n.x};
  bitangent = {b, sign + n.y * n.y * a, -n.y};
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
