#pragma once
/// \file Surfaces of mesh hits for one instruction set: the operations of surface_interaction() in the same
/// order, on several hits at once.

#include "accel/surface/mesh_interactions.h"
#include "core/lanes.h"

namespace oktett {

template <class F>
OKTETT_INLINE Vec3<F> load_lanes(const float (&column)[3][MeshInteractions::kMost], std::size_t i) {
  return {F::load(column[0] + i), F::load(column[1] + i), F::load(column[2] + i)};
}

template <class F>
OKTETT_INLINE void store_lanes(const Vec3<F>& v, float (&column)[3][MeshInteractions::kMost], std::size_t i) {
  v.x.store(column[0] + i), v.y.store(column[1] + i), v.z.store(column[2] + i);
}

template <int W, class A>
OKTETT_INLINE Vec3<Simd<float, W, A>> to_float(const Vec3<Simd<double, W, A>>& v) {
  return {to_float(v.x), to_float(v.y), to_float(v.z)};
}

/// a wa + b wb + c wc in each component.
template <class F>
OKTETT_INLINE Vec3<F> weigh(const Vec3<F> (&p)[3], const F& wa, const F& wb, const F& wc) {
  return {p[0].x * wa + p[1].x * wb + p[2].x * wc, p[0].y * wa + p[1].y * wb + p[2].y * wc,
          p[0].z * wa + p[1].z * wb + p[2].z * wc};
}

/// See mesh_surface in accel/surface/surface_interaction.cpp for the bound.
template <class F>
OKTETT_INLINE F weighted_error(const F& a, const F& b, const F& c, const F& wa, const F& wb, const F& wc) {
  const F magnitude = abs(a * wa) + abs(b * wb) + abs(c * wc);
  const F spread = abs(b - a) + abs(c - a);
  return F(0x1p-21f) * magnitude + F(0x1p-22f) * spread + F(1e-37f);
}

template <class D>
OKTETT_INLINE Vec3<D> transform_point(const Affine& m, const Vec3<D>& p) {
  const auto row = [&](int i) {
    return D(m.m[i][0]) * p.x + D(m.m[i][1]) * p.y + D(m.m[i][2]) * p.z + D(m.m[i][3]);
  };
  return {row(0), row(1), row(2)};
}

template <class D>
OKTETT_INLINE Vec3<D> transform_normal(const Affine& inverse, const Vec3<D>& n) {
  const auto column = [&](int i) {
    return D(inverse.m[0][i]) * n.x + D(inverse.m[1][i]) * n.y + D(inverse.m[2][i]) * n.z;
  };
  return {column(0), column(1), column(2)};
}

template <class A>
void mesh_interactions_code(MeshInteractions& s) {
  constexpr int W = std::is_same_v<A, ScalarIsa> ? 1 : 8;
  using F = Simd<float, W, A>;
  using D = Simd<double, W, A>;
  const D side(s.mirrored ? -1.0 : 1.0);
  for (std::size_t i = 0; i < s.count; i += W) {
    Vec3<F> p[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = load_lanes<F>(s.corner[k], i);
      if (s.to_world != nullptr) p[k] = to_float(transform_point(*s.to_world, to_double(p[k])));
    }
    const F u = F::load(s.u + i), v = F::load(s.v + i), w = F(1.0f) - u - v;
    store_lanes(weigh(p, w, u, v), s.position, i);
    store_lanes(Vec3<F>{weighted_error(p[0].x, p[1].x, p[2].x, w, u, v),
                        weighted_error(p[0].y, p[1].y, p[2].y, w, u, v),
                        weighted_error(p[0].z, p[1].z, p[2].z, w, u, v)},
                s.position_error, i);
    const Vec3<D> a = to_double(p[0]);
    const Vec3<D> n = cross_lanes(sub_lanes(to_double(p[1]), a), sub_lanes(to_double(p[2]), a));
    const D size = sqrt(dot_lanes(n, n));
    const Vec3<F> ng = to_float(Vec3<D>{n.x / size * side, n.y / size * side, n.z / size * side});
    store_lanes(ng, s.geometric_normal, i);
    if (!s.smooth) {
      store_lanes(ng, s.shading_normal, i);
      continue;
    }
    const Vec3<F> corner_normals[3] = {load_lanes<F>(s.normal[0], i), load_lanes<F>(s.normal[1], i),
                                       load_lanes<F>(s.normal[2], i)};
    Vec3<D> m = to_double(weigh(corner_normals, w, u, v));
    if (s.inverse != nullptr) m = transform_normal(*s.inverse, m);
    const D length = sqrt(dot_lanes(m, m));
    // Neither zero, infinite nor NaN.
    const auto known = mask_cast<float>((D(0.0) < length) & (length <= D(1.7976931348623157e308)));
    const Vec3<F> ns = to_float(Vec3<D>{m.x / length, m.y / length, m.z / length});
    store_lanes(Vec3<F>{select(known, ns.x, ng.x), select(known, ns.y, ng.y), select(known, ns.z, ng.z)},
                s.shading_normal, i);
  }
}

}  // namespace oktett
