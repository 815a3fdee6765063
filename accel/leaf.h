#pragma once
/// \file Rays against the contents of a leaf. Every function here either finds the hits that the shapes'
/// kernels decide, or rejects conservatively; the order of visits cannot change a result.

#include "accel/instance.h"
#include "accel/ray_state.h"

namespace oktett {

/// What a traversal looks for.
enum class Query { closest, any };

template <int W, class A>
OKTETT_INLINE RayLanes<Simd<float, W, A>> load_rays(const RayState<W, A>& r) {
  using F = Simd<float, W, A>;
  return {{F::load(r.o[0]), F::load(r.o[1]), F::load(r.o[2])},
          {F::load(r.d[0]), F::load(r.d[1]), F::load(r.d[2])},
          F::load(r.tmin),
          F::load(r.tmax)};
}

/// The shear of W rays that share the axis `z`.
template <int W, class A>
OKTETT_INLINE ShearLanes<Simd<double, W, A>> load_shear(const RayState<W, A>& r, int z) {
  using F = Simd<float, W, A>;
  using D = Simd<double, W, A>;
  return {{to_double(F::load(r.o[(z + 1) % 3])), to_double(F::load(r.o[(z + 2) % 3])),
           to_double(F::load(r.o[z]))},
          to_double(F::load(r.d[z])),
          D::load(r.shear_x),
          D::load(r.shear_y)};
}

/// Ray `i` in all N lanes.
template <int N, int W, class A>
OKTETT_INLINE RayLanes<Simd<float, N, A>> broadcast_ray(const RayState<W, A>& r, int i) {
  using F = Simd<float, N, A>;
  return {{F(r.o[0][i]), F(r.o[1][i]), F(r.o[2][i])},
          {F(r.d[0][i]), F(r.d[1][i]), F(r.d[2][i])},
          F(r.tmin[i]),
          F(r.tmax[i])};
}

template <int N, int W, class A>
OKTETT_INLINE ShearLanes<Simd<double, N, A>> broadcast_shear(const RayState<W, A>& r, int i) {
  using D = Simd<double, N, A>;
  const int z = r.z_axis_of(i);
  return {{D(r.o[(z + 1) % 3][i]), D(r.o[(z + 2) % 3][i]), D(r.o[z][i])},
          D(r.d[z][i]),
          D(r.shear_x[i]),
          D(r.shear_y[i])};
}

/// Hits of W rays with one item, for the rays in `lanes`.
template <int W, class A>
OKTETT_INLINE void accept_packet(RayState<W, A>& r, unsigned lanes, const HitLanes<Simd<float, W, A>>& h,
                                 std::uint32_t item) {
  alignas(64) float t[W], u[W], v[W];
  h.t.store(t), h.u.store(u), h.v.store(v);
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    accept_hit(r, i, t[i], u[i], v[i], item, kNoId);
  }
}

/// Hits of ray `i` with N items; for Query::any one is enough.
template <int N, int W, class A>
OKTETT_INLINE void accept_single(RayState<W, A>& r, int i, unsigned lanes,
                                 const HitLanes<Simd<float, N, A>>& h, const std::uint32_t* items) {
  alignas(64) float t[N], u[N], v[N];
  h.t.store(t), h.u.store(u), h.v.store(v);
  for (; lanes != 0; lanes &= lanes - 1) {
    const int k = __builtin_ctz(lanes);
    accept_hit(r, i, t[k], u[k], v[k], items[k], kNoId);
  }
}

/// One of the textbook triangle tests on any lanes.
template <class F>
OKTETT_INLINE typename F::M textbook_test(TriangleTest test, const RayLanes<F>& ray,
                                          const TriangleLanes<F>& tri, HitLanes<F>& hit) {
  if (test == TriangleTest::moller_trumbore) return moller_trumbore(ray, tri, hit);
  if (test == TriangleTest::badouel) return badouel(ray, tri, hit);
  return segura_feito(ray, tri, hit);
}

// --- one ray
// ----------------------------------------------------------------------------------------------------------

/// Ray `i` against the first `count` triangles of a block, eight at a time.
template <int W, class A>
OKTETT_INLINE void leaf_triangles_single(const TriangleBlock& block, int count, RayState<W, A>& r, int i) {
  constexpr int N = TriangleBlock::kSize;
  using F = Simd<float, N, A>;
  const auto ray = broadcast_ray<N>(r, i);
  const auto tri = load_triangles<F>(block);
  unsigned lanes = bits(filter_watertight(ray, F(r.d_max[i]), filter_triangle(tri))) & ((1u << count) - 1);
  if (lanes == 0) return;
  HitLanes<F> hit;
  lanes &= bits(decide_watertight(broadcast_shear<N>(r, i), load_triangles<F>(block, 0, r.z_axis_of(i)),
                                  ray.tmin, ray.tmax, hit));
  if (lanes != 0) accept_single<N>(r, i, lanes, hit, block.item);
}

template <int W, class A>
OKTETT_NOINLINE void leaf_textbook_single(TriangleTest test, const TriangleBlock& block, int count,
                                          RayState<W, A>& r, int i) {
  constexpr int N = TriangleBlock::kSize;
  using F = Simd<float, N, A>;
  HitLanes<F> hit;
  const unsigned lanes =
      bits(textbook_test(test, broadcast_ray<N>(r, i), load_triangles<F>(block), hit)) & ((1u << count) - 1);
  if (lanes != 0) accept_single<N>(r, i, lanes, hit, block.item);
}

/// How many primitives of S one ray meets at once.
template <class S>
inline constexpr int kShapeLanes = 8;
template <>
inline constexpr int kShapeLanes<Polygon> = 1;

template <class S, int W, class A>
OKTETT_INLINE void leaf_shape_single(const typename S::Pool& pool, std::uint32_t begin, int count,
                                     RayState<W, A>& r, int i) {
  constexpr int N = kShapeLanes<S>;
  using F = Simd<float, N, A>;
  using D = Simd<double, N, A>;
  for (int k = 0; k < count; k += N) {
    const auto ray = broadcast_ray<N>(r, i);
    HitLanes<F> hit;
    const auto found = first_root<S>(ray, to_double(ray), S::template load<D>(pool, begin + k), hit);
    const int rest = count - k;
    const unsigned lanes = bits(found) & (rest >= N ? (1u << N) - 1 : (1u << rest) - 1);
    if (lanes != 0) accept_single<N>(r, i, lanes, hit, &pool.item[begin + k]);
  }
}

// --- a packet
// -----------------------------------------------------------------------------------------------------------

/// The rays in `lanes` against the triangles of a block, one triangle at a time. All of `lanes` share the
/// axis `z`.
template <int W, class A>
OKTETT_INLINE void leaf_triangles_packet(const TriangleBlock& block, int count, RayState<W, A>& r,
                                         unsigned lanes, int z) {
  using F = Simd<float, W, A>;
  const F d_max = F::load(r.d_max);
  for (int k = 0; k < count; ++k) {
    const auto ray = load_rays(r);
    const unsigned maybe =
        bits(filter_watertight(ray, d_max, filter_triangle(broadcast_triangle<F>(block, k)))) & lanes;
    if (maybe == 0) continue;
    HitLanes<F> hit;
    const unsigned hits = bits(decide_watertight(load_shear(r, z), broadcast_triangle<F>(block, k, z),
                                                 ray.tmin, ray.tmax, hit)) &
                          maybe;
    if (hits != 0) accept_packet(r, hits, hit, block.item[k]);
  }
}

template <int W, class A>
OKTETT_NOINLINE void leaf_textbook_packet(TriangleTest test, const TriangleBlock& block, int count,
                                          RayState<W, A>& r, unsigned lanes) {
  using F = Simd<float, W, A>;
  for (int k = 0; k < count; ++k) {
    HitLanes<F> hit;
    const unsigned hits =
        bits(textbook_test(test, load_rays(r), broadcast_triangle<F>(block, k), hit)) & lanes;
    if (hits != 0) accept_packet(r, hits, hit, block.item[k]);
  }
}

template <class S, int W, class A>
OKTETT_INLINE void leaf_shape_packet(const typename S::Pool& pool, std::uint32_t begin, int count,
                                     RayState<W, A>& r, unsigned lanes) {
  using F = Simd<float, W, A>;
  using D = Simd<double, W, A>;
  for (int k = 0; k < count; ++k) {
    const auto ray = load_rays(r);
    HitLanes<F> hit;
    const unsigned hits =
        bits(first_root<S>(ray, to_double(ray), S::template broadcast<D>(pool, begin + k), hit)) & lanes;
    if (hits != 0) accept_packet(r, hits, hit, pool.item[begin + k]);
  }
}

}  // namespace oktett
