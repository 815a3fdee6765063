#pragma once
/// \file Rays against the shapes of a leaf. A hit is always decided by the shape's kernel, after filters that
/// reject conservatively, so the order in which leaves are visited changes no result.

#include "accel/hit_sink.h"
#include "accel/instance.h"
#include "accel/ray_state.h"
#include "core/lanes.h"
#include "kernels/closed/sphere.h"
#include "kernels/triangle/triangle.h"

namespace oktett {

// ---- Rays side by side against spheres in float, before the test in double.

/// Tells which rays may meet a sphere. Those that are left out pass its centre at more than its radius; the
/// bounds on the rounding errors are derived in docs/numerics.md. The exact test takes about three times as
/// many steps, on half as many lanes.
template <class F>
class SphereFilter {
 public:
  /// Eight spheres, rounded.
  struct Spheres {
    static constexpr int kSize = 8;
    alignas(32) float x[kSize], y[kSize], z[kSize];
    alignas(32) float reach[kSize];  ///< square of the radius, and slack for the rounded centre

    /// Spheres `first` ... of the pool.
    OKTETT_INLINE void set(const Sphere::Pool& pool, std::size_t first) {
      using D = Simd<double, kSize, typename F::Isa>;
      const Sphere::Lanes<D> s = Sphere::load<D>(pool, first);
      const Vec3<D>& c = s.center;
      to_float(c.x).store(x), to_float(c.y).store(y), to_float(c.z).store(z);
      to_float(s.radius * s.radius * D(1 + 0x1p-20) + dot_lanes(c, c) * D(kSlack) + D(kLeastSlack))
          .store(reach);
    }
  };

  OKTETT_INLINE explicit SphereFilter(const RayLanes<F>& ray) : o_(ray.o), d_(ray.d) {
    const F square = fast_dot(d_, d_);
    inverse_ = F(1.0f) / square;
    // Outside of these limits the quotient is not exact enough, so no ray is left out.
    const auto tame = (F(0x1p-100f) <= square) & (square <= F(0x1p100f));
    slack_ = select(tame, fast_dot(o_, o_) * F(kSlack), F(std::numeric_limits<float>::infinity()));
  }

  /// The rays that may meet sphere `k`, as bits.
  OKTETT_INLINE unsigned may_meet(const Spheres& s, int k) const {
    const Vec3<F> m{F(s.x[k]) - o_.x, F(s.y[k]) - o_.y, F(s.z[k]) - o_.z};
    const F closest = fast_dot(m, d_) * inverse_;
    const Vec3<F> miss{fast_fma(-closest, d_.x, m.x), fast_fma(-closest, d_.y, m.y),
                       fast_fma(-closest, d_.z, m.z)};
    // NaN is not left out.
    return ~bits(slack_ + F(s.reach[k]) < fast_dot(miss, miss));
  }

 private:
  /// Bound on the error of the squared distance, relative to the squares of the origin and of the centre.
  static constexpr float kSlack = 0x1p-16f;
  static constexpr float kLeastSlack = 0x1p-66f;  ///< for products that underflow

  Vec3<F> o_, d_;
  F inverse_, slack_;
};

// ---- Rays against the shapes of a leaf.

/// The rays of a state, in lanes.
template <int W, class A>
OKTETT_INLINE RayLanes<Simd<float, W, A>> load_rays(const RayState<W, A>& r) {
  return load_part<W>(r, 0);
}

/// The shear of W rays whose directions are greatest along axis `z`.
template <int W, class A>
OKTETT_INLINE ShearLanes<Simd<double, W, A>> load_shear(const RayState<W, A>& r, int z) {
  using F = Simd<float, W, A>;
  using D = Simd<double, W, A>;
  return {{to_double(F::load(r.o[(z + 1) % 3])), to_double(F::load(r.o[(z + 2) % 3])),
           to_double(F::load(r.o[z]))},
          D::load(r.inv_dz),
          D::load(r.shear_x),
          D::load(r.shear_y)};
}

/// One ray in all N lanes.
template <int N, class A>
OKTETT_INLINE RayLanes<Simd<float, N, A>> broadcast_ray(const RayState<1, A>& r) {
  const auto load = [](const float* column) { return Simd<float, N, A>(*column); };
  return load_ray_lanes(load, r.o, r.d, r.tmin, r.tmax);
}

/// The shear of one ray in all N lanes.
template <int N, class A>
OKTETT_INLINE ShearLanes<Simd<double, N, A>> broadcast_shear(const RayState<1, A>& r) {
  using D = Simd<double, N, A>;
  const int z = r.z_axis_of(0);
  return {{D(r.o[(z + 1) % 3][0]), D(r.o[(z + 2) % 3][0]), D(r.o[z][0])},
          D(r.inv_dz[0]),
          D(r.shear_x[0]),
          D(r.shear_y[0])};
}

/// Keeps the hits of the rays in `lanes` with one item where they are the nearest so far.
template <int W, class A>
OKTETT_INLINE void accept_packet(RayState<W, A>& r, unsigned lanes, const HitLanes<Simd<float, W, A>>& h,
                                 std::uint32_t item) {
  using F = Simd<float, W, A>;
  using I = Simd<std::int32_t, W, A>;
  const F nearest = F::load(r.tmax);
  // At equal distance the numbers of the items decide.
  if (const unsigned same = lanes & bits(h.t == nearest); OKTETT_UNLIKELY(same != 0))
    each_hit(same, h, [&](int i, float t, float u, float v) { accept_hit(r, i, t, u, v, item, kNoId); });
  const auto nearer = F::M::from_bits(lanes) & (h.t < nearest);
  select(nearer, h.t, nearest).store(r.tmax);
  select(nearer, h.u, F::load(r.u)).store(r.u), select(nearer, h.v, F::load(r.v)).store(r.v);
  const auto name = [&](std::uint32_t(&column)[W], std::uint32_t value) {
    auto* ids = reinterpret_cast<std::int32_t*>(column);
    select(mask_cast<std::int32_t>(nearer), I(static_cast<std::int32_t>(value)), I::load(ids)).store(ids);
  };
  name(r.item, item), name(r.path, kNoId);
}

/// Keeps the nearest of one ray's hits with the items in `lanes`, if it is the nearest so far.
template <int N, class A>
OKTETT_INLINE void accept_single(RayState<1, A>& r, unsigned lanes, const HitLanes<Simd<float, N, A>>& h,
                                 const std::uint32_t* items) {
  each_hit(lanes, h, [&](int k, float t, float u, float v) { accept_hit(r, 0, t, u, v, items[k], kNoId); });
}

/// One of the textbook triangle tests on any lanes.
template <class F>
OKTETT_INLINE typename F::M textbook_test(TriangleTest test, const RayLanes<F>& ray,
                                          const TriangleLanes<F>& tri, HitLanes<F>& hit) {
  if (test == TriangleTest::moller_trumbore) return moller_trumbore(ray, tri, hit);
  if (test == TriangleTest::badouel) return badouel(ray, tri, hit);
  return segura_feito(ray, tri, hit);
}

/// One ray against the first `count` triangles of a block, all at once. A call: many places need it rarely.
template <class A>
OKTETT_NOINLINE void leaf_triangles_single(const TriangleLeaf& leaf, int count, RayState<1, A>& r) {
  constexpr int N = TriangleBlock::kSize;
  using F = Simd<float, N, A>;
  const auto ray = broadcast_ray<N>(r);
  const auto tri = load_triangles<F>(leaf);
  unsigned lanes = bits(filter_watertight(ray, F(r.d_max[0]), filter_triangle(tri))) & ((1u << count) - 1);
  if (lanes == 0) return;
  HitLanes<F> hit;
  lanes &= bits(decide_watertight(broadcast_shear<N>(r), load_triangles<F>(leaf, 0, r.z_axis_of(0)), ray.tmin,
                                  ray.tmax, hit));
  if (lanes != 0) accept_single<N>(r, lanes, hit, leaf.items());
}

/// The same by one of the textbook tests.
template <class A>
OKTETT_NOINLINE void leaf_textbook_single(TriangleTest test, const TriangleLeaf& leaf, int count,
                                          RayState<1, A>& r) {
  constexpr int N = TriangleBlock::kSize;
  using F = Simd<float, N, A>;
  HitLanes<F> hit;
  const unsigned lanes =
      bits(textbook_test(test, broadcast_ray<N>(r), load_triangles<F>(leaf), hit)) & ((1u << count) - 1);
  if (lanes != 0) accept_single<N>(r, lanes, hit, leaf.items());
}

/// How many primitives of S are tested against one ray at once.
template <class S>
inline constexpr int kShapeLanes = 8;
template <>
inline constexpr int kShapeLanes<Polygon> = 1;

/// One ray against `count` primitives of closed-form shape S from `begin` on.
template <class S, class A>
OKTETT_INLINE void leaf_shape_single(const typename S::Pool& pool, std::uint32_t begin, int count,
                                     RayState<1, A>& r) {
  constexpr int N = kShapeLanes<S>;
  using F = Simd<float, N, A>;
  using D = Simd<double, N, A>;
  for (int k = 0; k < count; k += N) {
    const auto ray = broadcast_ray<N>(r);
    HitLanes<F> hit;
    const auto found = first_root<S>(ray, to_double(ray), S::template load<D>(pool, begin + k), hit);
    const int rest = count - k;
    const unsigned lanes = bits(found) & (rest >= N ? (1u << N) - 1 : (1u << rest) - 1);
    if (lanes != 0) accept_single<N>(r, lanes, hit, &pool.item[begin + k]);
  }
}

/// Decides triangle `k` of a block for the rays in `maybe`, which share the greatest axis `z`.
template <int W, class A>
OKTETT_INLINE void decide_packet(const TriangleLeaf& leaf, int k, RayState<W, A>& r, unsigned maybe, int z) {
  using F = Simd<float, W, A>;
  HitLanes<F> hit;
  const unsigned hits = maybe & bits(decide_watertight(load_shear(r, z), broadcast_triangle<F>(leaf, k, z),
                                                       F::load(r.tmin), F::load(r.tmax), hit));
  if (hits != 0) accept_packet(r, hits, hit, leaf.item(k));
}

/// The rays in `lanes` against the triangles of a block. All triangles are prepared for the filter at once,
/// in lanes; then each is tested against all rays.
template <int W, class A>
OKTETT_INLINE void leaf_triangles_packet(const TriangleLeaf& leaf, int count, RayState<W, A>& r,
                                         unsigned lanes, int z) {
  using F = Simd<float, W, A>;
  using B = Simd<float, TriangleBlock::kSize, A>;
  alignas(64) float row[13][TriangleBlock::kSize];
  const FilterTriangle<B> f = filter_triangle(load_triangles<B>(leaf));
  const Vec3<B>* vectors[4] = {&f.a, &f.e1, &f.e2, &f.n};
  for (int i = 0; i < 4; ++i)
    vectors[i]->x.store(row[3 * i]), vectors[i]->y.store(row[3 * i + 1]), vectors[i]->z.store(row[3 * i + 2]);
  f.size.store(row[12]);
  const F d_max = F::load(r.d_max);
  for (int k = 0; k < count; ++k) {
    const auto vec = [&](int i) {
      return Vec3<F>{F(row[3 * i][k]), F(row[3 * i + 1][k]), F(row[3 * i + 2][k])};
    };
    const FilterTriangle<F> tri{vec(0), vec(1), vec(2), vec(3), F(row[12][k])};
    const unsigned maybe = bits(filter_watertight(load_rays(r), d_max, tri)) & lanes;
    if (maybe != 0) decide_packet(leaf, k, r, maybe, z);
  }
}

/// The same for rays that all start at `o`: the filter takes only three dot products with the direction per
/// ray.
template <int W, class A>
OKTETT_INLINE void leaf_triangles_origin(const TriangleLeaf& leaf, int count, RayState<W, A>& r,
                                         unsigned lanes, int z, const Vec3f& o, float d_max) {
  using F = Simd<float, W, A>;
  using B = Simd<float, TriangleBlock::kSize, A>;
  alignas(64) float row[12][TriangleBlock::kSize];
  const OriginTriangle<B> f =
      origin_triangle(filter_triangle(load_triangles<B>(leaf)), broadcast<B>(o), B(d_max));
  const Vec3<B>* vectors[3] = {&f.u, &f.v, &f.det};
  for (int i = 0; i < 3; ++i)
    vectors[i]->x.store(row[3 * i]), vectors[i]->y.store(row[3 * i + 1]), vectors[i]->z.store(row[3 * i + 2]);
  f.t.store(row[9]), f.error.store(row[10]), f.t_error.store(row[11]);
  const Vec3<F> d{F::load(r.d[0]), F::load(r.d[1]), F::load(r.d[2])};
  for (int k = 0; k < count; ++k) {
    const auto vec = [&](int i) {
      return Vec3<F>{F(row[3 * i][k]), F(row[3 * i + 1][k]), F(row[3 * i + 2][k])};
    };
    const OriginTriangle<F> tri{vec(0), vec(1), vec(2), F(row[9][k]), F(row[10][k]), F(row[11][k])};
    const unsigned maybe = bits(filter_watertight(d, F::load(r.tmax), tri)) & lanes;
    if (maybe != 0) decide_packet(leaf, k, r, maybe, z);
  }
}

/// The rays in `lanes` against the triangles of a block by one of the textbook tests.
template <int W, class A>
OKTETT_NOINLINE void leaf_textbook_packet(TriangleTest test, const TriangleLeaf& leaf, int count,
                                          RayState<W, A>& r, unsigned lanes) {
  using F = Simd<float, W, A>;
  for (int k = 0; k < count; ++k) {
    HitLanes<F> hit;
    const unsigned hits =
        bits(textbook_test(test, load_rays(r), broadcast_triangle<F>(leaf, k), hit)) & lanes;
    if (hits != 0) accept_packet(r, hits, hit, leaf.item(k));
  }
}

/// The rays in `lanes` against primitive `k` of a pool of closed-form shape S.
template <class S, int W, class A>
OKTETT_INLINE void shape_packet(const typename S::Pool& pool, std::size_t k, RayState<W, A>& r,
                                unsigned lanes) {
  using D = Simd<double, W, A>;
  const auto ray = load_rays(r);
  HitLanes<Simd<float, W, A>> hit;
  const unsigned hits =
      bits(first_root<S>(ray, to_double(ray), S::template broadcast<D>(pool, k), hit)) & lanes;
  if (hits != 0) accept_packet(r, hits, hit, pool.item[k]);
}

/// The rays in `lanes` against `count` primitives of closed-form shape S from `begin` on.
template <class S, int W, class A>
OKTETT_INLINE void leaf_shape_packet(const typename S::Pool& pool, std::uint32_t begin, int count,
                                     RayState<W, A>& r, unsigned lanes) {
  if constexpr (std::is_same_v<S, Sphere>) {
    using Filter = SphereFilter<Simd<float, W, A>>;
    const Filter filter(load_rays(r));
    typename Filter::Spheres spheres;
    for (int k = 0; k < count; ++k) {
      if (k % Filter::Spheres::kSize == 0) spheres.set(pool, begin + k);
      const unsigned maybe = filter.may_meet(spheres, k % Filter::Spheres::kSize) & lanes;
      if (maybe != 0) shape_packet<S>(pool, begin + k, r, maybe);
    }
  } else {
    for (int k = 0; k < count; ++k) shape_packet<S>(pool, begin + k, r, lanes);
  }
}

}  // namespace oktett
