#pragma once
/// \file Rays on their way through a tree: what is computed once per ray, and the nearest hit so far.

#include <cstring>

#include "accel/accel_data.h"
#include "core/lanes.h"
#include "core/ray.h"
#include "kernels/closed/slab.h"

namespace oktett {

// ---- Rays on their way through a tree.

/// Rays that one vector of floats holds: those of a chunk, and of a packet where nothing says how many.
template <class A>
inline constexpr int kChunkRays = std::is_same_v<A, Avx512Isa> ? 16 : 8;

/// Greatest |coordinate| in the box.
OKTETT_INLINE float box_extent(const Box& b) {
  float e = 0;
  for (int k = 0; k < 3; ++k) {
    const float lo = __builtin_fabsf(b.lo[k]), hi = __builtin_fabsf(b.hi[k]);
    e = lo > e ? lo : e, e = hi > e ? hi : e;
  }
  return e;
}

/// Sets components whose reciprocal would overflow to zero, so that the slab test and the triangle test see
/// the same ray. -0 becomes +0, so that the sign of the reciprocal agrees with the comparison with zero.
template <class F>
OKTETT_INLINE Vec3<F> flush_direction(const Vec3<F>& d) {
  const auto flush = [](const F& x) {
    return select(abs(x) < F(std::numeric_limits<float>::min()), F(0.0f), x);
  };
  return {flush(d.x), flush(d.y), flush(d.z)};
}

/// W rays in columns; a single ray is the case W = 1. `tmax` shrinks to the distance of the nearest hit so
/// far, which `item`, `path`, `u` and `v` describe (item = kNoId: none yet). Masks have bit i for lane i.
template <int W, class A>
struct alignas(64) RayState {
  using F = Simd<float, W, A>;
  using D = Simd<double, W, A>;

  float o[3][W], d[3][W], inv[3][W];
  float tmin[W], tmax[W];
  float slack[W];
  float d_max[W];                            ///< greatest |component|, see filter_watertight
  double inv_dz[W], shear_x[W], shear_y[W];  ///< see ShearLanes
  float u[W], v[W];
  std::uint32_t item[W], path[W];
  unsigned negative[3];  ///< lanes whose direction component is negative
  unsigned z_axis[3];    ///< lanes whose direction is greatest along the axis, for the triangle test

  /// Index of the axis along which ray i's direction is greatest.
  OKTETT_INLINE int z_axis_of(int i) const { return z_axis[0] >> i & 1 ? 0 : z_axis[1] >> i & 1 ? 1 : 2; }

  /// Sets all lanes. Returns those that can hit anything: finite, with a direction and a range that is not
  /// empty (see Ray). `box`: bounds of what will be traced.
  OKTETT_INLINE unsigned set(const Vec3<F>& origin, const Vec3<F>& ray_direction, const F& t0, const F& t1,
                             const Box& box) {
    const unsigned lanes = set_rays(origin, ray_direction, t0, t1);
    const F zero(0.0f);
    const Vec3<F> direction = flush_direction(ray_direction);
    const F ax = abs(direction.x), ay = abs(direction.y), az = abs(direction.z);
    const auto zx = (ax >= ay) & (ax >= az), zy = ~zx & (ay >= az);
    const F dm = max(az, max(ay, ax));
    const F om = max(abs(origin.z), max(abs(origin.y), abs(origin.x)));
    store({F(1.0f) / direction.x, F(1.0f) / direction.y, F(1.0f) / direction.z}, inv);
    select(dm <= F(kFilterMaxDirection), dm, F(std::numeric_limits<float>::infinity())).store(d_max);

    const auto pick = [&](const F& x, const F& y, const F& z) { return select(zx, x, select(zy, y, z)); };
    const D inverse = D(1.0) / to_double(pick(direction.x, direction.y, direction.z));
    inverse.store(inv_dz);
    (to_double(pick(direction.y, direction.z, direction.x)) * inverse).store(shear_x);
    (to_double(pick(direction.z, direction.x, direction.y)) * inverse).store(shear_y);
    const float extent = box_extent(box);
    ((om + F(extent)) / dm * F(kSlabAbsoluteSlack) + F(kSlabUnderflow)).store(slack);

    negative[0] = bits(direction.x < zero), negative[1] = bits(direction.y < zero),
    negative[2] = bits(direction.z < zero);
    z_axis[0] = bits(zx), z_axis[1] = bits(zy), z_axis[2] = bits(~(zx | zy));
    return lanes;
  }

  /// The same for a single ray.
  OKTETT_INLINE unsigned set(const Ray& ray, const Box& box) requires(W == 1) {
    return set(broadcast<F>(ray.origin), broadcast<F>(ray.direction), F(ray.tmin), F(ray.tmax), box);
  }

  /// Like `set`, but only origin, direction, range and hit: all that closed-form shapes need.
  OKTETT_INLINE unsigned set_rays(const Vec3<F>& origin, const Vec3<F>& ray_direction, const F& t0,
                                  const F& t1) {
    const F zero(0.0f), big(std::numeric_limits<float>::max());
    const Vec3<F> direction = flush_direction(ray_direction);
    const F ax = abs(direction.x), ay = abs(direction.y), az = abs(direction.z);
    store(origin, o), store(direction, d);
    t0.store(tmin), t1.store(tmax);
    zero.store(u), zero.store(v);
    std::memset(item, 0xff, sizeof item), std::memset(path, 0xff, sizeof path);
    // Every component is compared, because a comparison is false on NaN while max() may lose it.
    return bits((ax <= big) & (ay <= big) & (az <= big) & (abs(origin.x) <= big) & (abs(origin.y) <= big) &
                (abs(origin.z) <= big) & (zero < max(az, max(ay, ax))) & (zero <= t0) & (t0 < t1));
  }

  /// Ray i by itself.
  OKTETT_INLINE RayState<1, A> lane(int i) const {
    RayState<1, A> one;
    for (int k = 0; k < 3; ++k) {
      one.o[k][0] = o[k][i], one.d[k][0] = d[k][i], one.inv[k][0] = inv[k][i];
      one.negative[k] = negative[k] >> i & 1, one.z_axis[k] = z_axis[k] >> i & 1;
    }
    one.tmin[0] = tmin[i], one.slack[0] = slack[i], one.d_max[0] = d_max[i];
    one.inv_dz[0] = inv_dz[i], one.shear_x[0] = shear_x[i], one.shear_y[0] = shear_y[i];
    one.tmax[0] = tmax[i], one.u[0] = u[i], one.v[0] = v[i], one.item[0] = item[i], one.path[0] = path[i];
    return one;
  }
  /// Ray i ends where ray k of another state does, and takes over its hit.
  template <int V>
  OKTETT_INLINE void take(int i, const RayState<V, A>& other, int k) {
    tmax[i] = other.tmax[k], u[i] = other.u[k], v[i] = other.v[k];
    item[i] = other.item[k], path[i] = other.path[k];
  }

  /// Ray i's nearest hit becomes `h`, if that is valid.
  OKTETT_INLINE void set_hit(int i, const Hit& h) {
    if (h.valid()) tmax[i] = h.t, u[i] = h.u, v[i] = h.v, item[i] = h.item, path[i] = h.instance;
  }

  OKTETT_INLINE Hit hit(int i) const {
    Hit h;
    if (item[i] != kNoId) h = {tmax[i], u[i], v[i], item[i], path[i]};
    return h;
  }

 private:
  OKTETT_INLINE static void store(const Vec3<F>& v, float (&columns)[3][W]) {
    v.x.store(columns[0]), v.y.store(columns[1]), v.z.store(columns[2]);
  }
};

/// True if (path, item) comes before (path_b, item_b): no instance (kNoId) first.
OKTETT_INLINE bool id_before(std::uint32_t path, std::uint32_t item, std::uint32_t path_b,
                             std::uint32_t item_b) {
  const std::uint32_t p = path + 1, q = path_b + 1;
  return p != q ? p < q : item < item_b;
}

/// Whether the first of two hits at equal distance counts: that of the earlier path and item; of one item,
/// several cells of which may meet there, that of the lesser v, then u.
OKTETT_INLINE bool comes_first(const Hit& a, const Hit& b) {
  if (a.instance != b.instance || a.item != b.item) return id_before(a.instance, a.item, b.instance, b.item);
  return a.v != b.v ? a.v < b.v : a.u < b.u;
}

/// Keeps the hit of lane `i` with `item` at distance t if it is the nearest so far, or as near and comes
/// first.
template <int W, class A>
OKTETT_INLINE void accept_hit(RayState<W, A>& r, int i, float t, float u, float v, std::uint32_t item,
                              std::uint32_t path) {
  if (t > r.tmax[i]) return;
  if (t == r.tmax[i] && r.item[i] != kNoId && !comes_first({t, u, v, item, path}, r.hit(i))) return;
  r.tmax[i] = t, r.u[i] = u, r.v[i] = v, r.item[i] = item, r.path[i] = path;
}

/// N numbers of a column of W from lane `base` on. Lanes past the end of a narrower column repeat its first.
template <int N, int W, class A>
OKTETT_INLINE Simd<float, N, A> load_part(const float* column, int base) {
  using F = Simd<float, N, A>;
  if constexpr (N <= W) return F::load(column + base);
  float padded[N];
  for (int i = 0; i < N; ++i) padded[i] = column[i < W ? i : 0];
  return F::load(padded);
}
/// N rays of a state, likewise.
template <int N, int W, class A>
OKTETT_INLINE RayLanes<Simd<float, N, A>> load_part(const RayState<W, A>& r, int base) {
  const auto load = [&](const float* column) { return load_part<N, W, A>(column, base); };
  return load_ray_lanes(load, r.o, r.d, r.tmin, r.tmax);
}

/// Those of `lanes` whose rays have a hit.
template <int W, class A>
OKTETT_INLINE unsigned found_lanes(const RayState<W, A>& r, unsigned lanes) {
  unsigned found = 0;
  for (; lanes != 0; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    if (r.item[i] != kNoId) found |= 1u << i;
  }
  return found;
}

// ---- Loads rays from columns into lanes.

/// W rays from column position `b`; lanes past the end repeat the last ray.
template <class F>
OKTETT_INLINE RayLanes<F> load_span(const RaySpan& rays, std::size_t b) {
  const auto load = [&](const float* column) { return F::load(column + b); };
  const auto load_tail = [&](const float* column) {
    return F::load_front(column + b, static_cast<int>(rays.size - b));
  };
  if (OKTETT_LIKELY(b + F::kWidth <= rays.size))
    return load_ray_lanes(load, rays.origin, rays.direction, rays.tmin, rays.tmax);
  return load_ray_lanes(load_tail, rays.origin, rays.direction, rays.tmin, rays.tmax);
}

}  // namespace oktett
