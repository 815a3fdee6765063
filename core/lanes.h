#pragma once
/// \file Rays, hits and vectors in lanes.
///
/// A kernel pairs lane i of the rays with lane i of the shapes. Either side may be one element broadcast to
/// all lanes, so one kernel tests a packet against one shape and one ray against several shapes.

#include "core/simd.h"
#include "core/vec3.h"

namespace oktett {

/// Rays in lanes of F, a Simd of float or double. A hit counts if tmin < t <= tmax.
template <class F>
struct RayLanes {
  Vec3<F> o, d;
  F tmin, tmax;
};

/// What a kernel finds in each lane; defined only where the returned mask is set.
template <class F>
struct HitLanes {
  F t, u, v;
};

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

}  // namespace oktett
