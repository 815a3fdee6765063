#pragma once
/// \file The surface at a hit of an exact shape.

#include <algorithm>
#include <cmath>

#include "kernels/closed/contract.h"
#include "kernels/exact/exact.h"
#include "kernels/fractals/fractal.h"

namespace oktett {

/// The gradient by the method that the element asks for. Differences step by `h` along each axis: forward
/// ones are off by about h |f''| / 2, central ones by h^2 |f'''| / 6, and both by the rounding of f over h.
template <class S>
Vec3d exact_gradient(const typename S::Pool& pool, std::size_t i, int part, const Vec3d& p) {
  const NormalMethod method = pool.frames[i].normals;
  if (method == NormalMethod::gradient) return S::gradient(pool, i, part, p);
  const bool central = method == NormalMethod::central;
  const double h = central ? 0x1p-17 : 0x1p-26, here = S::value(pool, i, part, p);
  Vec3d g;
  for (int k = 0; k < 3; ++k) {
    Vec3d ahead = p, behind = p;
    ahead[k] += h, behind[k] -= h;
    g[k] = central ? (S::value(pool, i, part, ahead) - S::value(pool, i, part, behind)) / (2 * h)
                   : (S::value(pool, i, part, ahead) - here) / h;
  }
  return g;
}

/// Value and gradient, in one go where the shape can.
template <class S>
Slope any_slope(const typename S::Pool& pool, std::size_t i, int part, const Vec3d& p) {
  using D = Simd<double, 1, ScalarIsa>;
  constexpr bool has_slope = requires(D & value, Vec3<D> & gradient) {
    S::slope(pool, i, D(), Vec3<D>(), value, gradient);
  };
  if constexpr (has_slope)
    return slope_at<S>(pool, i, part, p);
  else
    return {S::value(pool, i, part, p), S::gradient(pool, i, part, p)};
}

/// `p`, near the surface, moved onto it along the gradient by Newton's method; no farther than `reach`, where
/// it stays if the function has no slope to go by.
template <class S>
Vec3d settle(const typename S::Pool& pool, std::size_t i, int part, Vec3d p, double reach) {
  const Vec3d start = p;
  for (int k = 0; k < 3; ++k) {
    const Slope f = any_slope<S>(pool, i, part, p);
    const Vec3d q = p - f.gradient * (f.value / dot(f.gradient, f.gradient));
    if (!(length(q - start) <= reach)) return start;
    p = q;
  }
  return p;
}

/// Shading data of a hit that `ray` had with element `i` of `pool`; `with_uv` is called with the part, the
/// point in the own space, and the surface.
template <class S, class Function>
SurfaceInteraction exact_surface_and(const typename S::Pool& pool, std::size_t i, const Hit& hit,
                                     const Ray& ray, Function&& with_uv) {
  const ExactFrame& frame = pool.frames[i];
  const int part = static_cast<int>(hit.u);
  const double t = hit.t;
  const Vec3d q = frame.to_own.point(point_at(ray, t));
  // t was rounded to float: so far may the true point be, and twice that may a slanting ray lead to.
  const double reach = 0x1p-22 * length(frame.to_own.vector(Vec3d(ray.direction))) * t + 0x1p-40;
  const Vec3d p = settle<S>(pool, i, part, q, reach);
  SurfaceInteraction s;
  const Vec3d point = frame.to_world.point(p);
  const double size = length(point) + length(frame.to_world.vector({1, 1, 1}));
  set_position(s, point, ray, t, 0x1p-44 * size);
  Vec3d n = frame.to_own.normal_by_inverse(exact_gradient<S>(pool, i, part, p));
  double l = length(n);
  // At a singular point any normal is as good as another.
  if (!(l > 0 && std::isfinite(l))) n = -Vec3d(ray.direction), l = length(n);
  s.geometric_normal = s.shading_normal = Vec3f(n / l);
  with_uv(part, p, s);
  return s;
}

/// The same for shapes whose crossings have to be found again (kernels/fractals/fractal.h).
template <class F>
SurfaceInteraction fractal_surface(const typename F::Pool& pool, std::size_t i, const Hit& hit,
                                   const Ray& ray) {
  const ExactFrame& frame = pool.frames[i];
  const FractalQuery query{frame.to_own.point(Vec3d(ray.origin)), frame.to_own.vector(Vec3d(ray.direction))};
  const FractalCrossing c = resolve_crossing<F>(pool.elements[i], query, hit.t, hit.v);
  SurfaceInteraction s;
  const Vec3d point = frame.to_world.point(c.point);
  set_position(s, point, ray, c.t, 0x1p-44 * (length(point) + length(frame.to_world.vector({1, 1, 1}))));
  const Vec3d n = frame.to_own.normal_by_inverse(c.normal);
  s.geometric_normal = s.shading_normal = Vec3f(n / length(n));
  s.uv = {static_cast<float>(c.u), static_cast<float>(c.v)};
  s.tangent = Vec3f(frame.to_world.vector(c.tangent));
  return s;
}

template <class S>
SurfaceInteraction exact_surface(const typename S::Pool& pool, std::size_t i, const Hit& hit,
                                 const Ray& ray) {
  if constexpr (kIsFractal<S>)
    return fractal_surface<S>(pool, i, hit, ray);
  else
    return exact_surface_and<S>(pool, i, hit, ray, [&](int part, const Vec3d& p, SurfaceInteraction& s) {
      S::uv(pool, i, part, p, s);
      s.tangent = Vec3f(pool.frames[i].to_world.vector(Vec3d(s.tangent)));
    });
}

/// The same without uv and tangent.
template <class S>
SurfaceInteraction exact_surface_without_uv(const typename S::Pool& pool, std::size_t i, const Hit& hit,
                                            const Ray& ray) {
  if constexpr (kIsFractal<S>)
    return fractal_surface<S>(pool, i, hit, ray);
  else
    return exact_surface_and<S>(pool, i, hit, ray, [](int, const Vec3d&, SurfaceInteraction&) {});
}

}  // namespace oktett
