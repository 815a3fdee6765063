#pragma once
/// \file What a closed-form shape offers the tracer, and how its roots become hits.
///
/// A shape S (one file each, a line in OKTETT_CLOSED_FORMS) has
/// - `S::Data`: what describes it. It is flat (kIsFlat) or has an inside. If it describes several shapes,
///   `S::count(data)` and `S::nth(data, i)` are these; else it is the shape;
/// - `S::is_empty(shape)`: whether there is nothing to meet;
/// - `S::kNeedsSimilarity`: whether other maps than similarities distort it into something else; then it is
///   shown through an instance;
/// - `S::Pool`: columns of double, one element per primitive, plus `item` numbers.
///   `S::add(pool, shape, to_world, item)` appends a shape that is not empty; `S::finish` pads with
///   primitives that are never hit, so that lanes may be loaded past the end. See NumberedShape;
/// - `S::Lanes<D>`, `S::load<D>(pool, i)`: primitives i, i + 1, ... in lanes; `S::broadcast<D>(pool, i)`: one
///   primitive in all lanes;
/// - `S::kRoots` and `S::roots(ray, lanes, t)`: where the ray's whole line meets the shape, t[0] <= t[1], and
///   a mask of the lanes where it does. Computed in double in a fixed order of operations, so that every
///   width and instruction set gives the same bits;
/// - `S::surface(pool, fetch, hits)`: SurfacePoints at HitPoints; fetch(column) returns the elements of a
///   pool's column in lanes;
/// - `S::uv(pool, i, hit, point, s)`: uv and tangents of a single hit, from its place on the ray and its
///   place on the surface;
/// - `S::uv_lanes(normal, u, v)`, if uv follows from the normal alone: uv in lanes;
/// - `S::bounds(pool, i)`, except for unbounded shapes; if `S::bounds(S::moved(shape, to_world))` is there,
/// it
///   serves the builder, without a pool;
/// - `S::inside(pool, i, point)` if it has an inside. With a single root it is a half-space, and its Lanes
///   and Pool have its normal;
/// - `S::closest(shape, to_world, p)`: the point of the surface nearest to p; the map is a similarity if the
///   shape needs one. `S::shape(pool, i)`, if it is there, is the shape in the world, else it is looked up.

#include <array>
#include <limits>

#include "core/box.h"
#include "core/soa.h"
#include "core/transform.h"
#include "kernels/closed/shape_data.h"
#include "kernels/closed/surface_points.h"

namespace oktett {

/// Whether S has an inside.
template <class S>
inline constexpr bool kSolid = !kIsFlat<typename S::Data>;

/// Whether uv of S is computed in lanes.
template <class S>
inline constexpr bool kHasUvLanes = requires(Simd<double, 1, ScalarIsa>& u,
                                             Vec3<Simd<double, 1, ScalarIsa>>& n) {
  S::uv_lanes(n, u, u);
};

/// How many lanes past its last element a pool must be readable.
inline constexpr int kPoolPadding = 16;

/// The part of the contract of a shape S whose primitives are N numbers each: `S::numbers(shape)`, which
/// `S::lanes<D>(number)` turns into S::Lanes<D>, where `number(k)` is number k.
template <class S, int N>
struct NumberedShape {
  struct Pool {
    Column<double> number[N];
    Column<std::uint32_t> item;
    std::size_t size() const { return item.size(); }
    std::size_t bytes() const { return number[0].bytes() * N + item.bytes(); }
    void add(const std::array<double, N>& numbers, std::uint32_t name) {
      for (int k = 0; k < N; ++k) number[k].push_back(numbers[k]);
      item.push_back(name);
    }
  };

  template <class Shape>
  static void add(Pool& p, const Shape& s, std::uint32_t item) {
    p.add(S::numbers(s), item);
  }
  template <class Shape>
  static void add(Pool& p, const Shape& s, const Affine& to_world, std::uint32_t item) {
    add(p, S::moved(s, to_world), item);
  }
  static void finish(Pool& p) {
    for (Column<double>& c : p.number)
      for (int i = 0; i < kPoolPadding; ++i) c.push_back(std::numeric_limits<double>::quiet_NaN());
  }

  template <class D>
  OKTETT_INLINE static auto load(const Pool& p, std::size_t i) {
    return S::template lanes<D>([&](int k) { return D::load(&p.number[k][i]); });
  }
  template <class D>
  OKTETT_INLINE static auto broadcast(const Pool& p, std::size_t i) {
    return S::template lanes<D>([&](int k) { return D(p.number[k][i]); });
  }
};

/// Takes the first root of each lane in `meets` inside (tmin, tmax] as the hit. Distances are rounded to
/// float, as hits store them, before they are compared, so that every traversal makes the same choice.
template <int K, int W, class A>
OKTETT_INLINE Mask<float, W, A> first_in_range(const RayLanes<Simd<float, W, A>>& ray,
                                               const Mask<float, W, A>& meets,
                                               const Simd<double, W, A> (&t)[K],
                                               HitLanes<Simd<float, W, A>>& hit) {
  using F = Simd<float, W, A>;
  const F far_limit = min(ray.tmax, F(3.402823466e38f));
  auto found = meets & ~meets;
  hit.t = F(0.0f);
  for (int k = K - 1; k >= 0; --k) {
    const F tk = to_float(t[k]);
    const auto valid = meets & (ray.tmin < tk) & (tk <= far_limit);
    hit.t = select(valid, tk, hit.t);
    found = found | valid;
  }
  hit.u = hit.v = F(0.0f);
  return found;
}

/// The first root of shape S in each lane.
template <class S, int W, class A>
OKTETT_INLINE Mask<float, W, A> first_root(const RayLanes<Simd<float, W, A>>& ray,
                                           const RayLanes<Simd<double, W, A>>& ray_d,
                                           const typename S::template Lanes<Simd<double, W, A>>& shape,
                                           HitLanes<Simd<float, W, A>>& hit) {
  Simd<double, W, A> t[S::kRoots];
  return first_in_range(ray, mask_cast<float>(S::roots(ray_d, shape, t)), t, hit);
}

/// A single hit of primitive i at distance t; without uv and tangents unless `with_uv`. Does not set the
/// names.
template <class S>
void closed_interaction(const typename S::Pool& pool, std::size_t i, const Ray& ray, double t, bool with_uv,
                        SurfaceInteraction& s) {
  using D = Simd<double, 1, ScalarIsa>;
  const HitPoints<D> hit(ray, t);
  const SurfacePoints<D> surface = S::surface(
      pool, [i](const Column<double>& column) { return D(column[i]); }, hit);
  s.position = Vec3f(only_lane(surface.point));
  s.position_error = only_lane(position_error(hit, surface.point, surface.error));
  s.geometric_normal = s.shading_normal = Vec3f(only_lane(surface.normal));
  if (with_uv) S::uv(pool, i, only_lane(hit.point()), only_lane(surface.point), s);
}

}  // namespace oktett
