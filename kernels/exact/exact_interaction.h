#pragma once
/// \file The surface interaction at hits of an exact surface: one formula for one hit and for many in lanes.

#include <cmath>
#include <limits>

#include "kernels/closed/surface_points.h"
#include "kernels/exact/exact.h"
#include "kernels/exact/exact_pool.h"

namespace oktett {

/// The gradient by differences of the function, which step by `h` along each axis. Forward ones are off by
/// about h |f''| / 2, central ones by h^2 |f'''| / 6, and both by the rounding of f over h.
template <class S>
Vec3d gradient_by_differences(const typename S::Pool& pool, std::size_t i, int part, const Vec3d& p) {
  const auto value = [&](const Vec3d& at) { return slope_at<S>(pool, i, part, at).value; };
  const bool central = pool.frames[i].normals == NormalMethod::central;
  const double h = central ? 0x1p-17 : 0x1p-26, here = value(p);
  Vec3d g;
  for (int k = 0; k < 3; ++k) {
    Vec3d ahead = p, behind = p;
    ahead[k] += h, behind[k] -= h;
    g[k] = central ? (value(ahead) - value(behind)) / (2 * h) : (value(ahead) - here) / h;
  }
  return g;
}

/// The surface near hits with element `i`: points moved onto it by Newton's method, along the normal that it
/// has in the world. A step along the gradient in the element's own space is the shortest one there, but a
/// flat map makes it longer in the world. A point that would go farther than rounding can have brought it
/// stays where it is: the function has no slope to go by there. `own` gets the points in the own space.
///
/// Several lanes ask for S::slope and NormalMethod::gradient.
template <class S, class D>
OKTETT_INLINE SurfacePoints<D> exact_surface_points(const typename S::Pool& pool, std::size_t i,
                                                    const D& part, const HitPoints<D>& hit, Vec3<D>& own) {
  // The second step is usually too short to matter; more are needed where the surface is sharp.
  constexpr int kMostSteps = 3;
  const ExactFrame& frame = pool.frames[i];
  const Vec3<D> world = hit.point(), start = map_point(frame.to_own, world);
  const D extent(stretch(frame.to_world));
  // t was rounded to float: so far may the true point be; a slanting ray may lead twice as far.
  const D reach = D(0x1p-22) * length_lanes(hit.d) * hit.t + D(0x1p-40) * extent;
  // A shorter step than that changes neither the point nor its normal.
  const D least_step = D(0x1p-44) * (length_lanes(world) + extent), zero(0.0);
  Vec3<D> p = start, moved = {zero, zero, zero}, n = moved, g;
  D value;
  auto stays_near = D::M::all_true(), done = ~stays_near;
  for (int step = 0;; ++step) {
    slope_lanes<S>(pool, i, part, p, value, g);
    const Vec3<D> here = map_normal(frame.to_own, g);
    n = select_lanes(done, n, here);
    if (step == kMostSteps) break;
    const Vec3<D> back = scale_lanes(here, value / dot_lanes(here, here)), next = sub_lanes(moved, back);
    stays_near = stays_near & (length_lanes(next) <= reach);
    moved = select_lanes(done, moved, next);
    const Vec3<D> there = add_lanes(start, map_vector(frame.to_own, moved));
    p = select_lanes(done, p, select_lanes(stays_near, there, start));
    done = done | (length_lanes(back) <= least_step);
    if (none(~done)) break;
  }
  if constexpr (D::kWidth == 1)
    if (frame.normals != NormalMethod::gradient)
      n = map_normal(frame.to_own, broadcast<D>(gradient_by_differences<S>(
                                       pool, i, static_cast<int>(only_lane(part)), only_lane(p))));
  D l = length_lanes(n);
  // At a singular point any normal is as good as another. Differences, since the sign of minus zero depends
  // on the instruction set.
  const auto known = (D(0.0) < l) & (l <= D(std::numeric_limits<double>::max()));
  n = select_lanes(known, n, Vec3<D>{zero - hit.d.x, zero - hit.d.y, zero - hit.d.z});
  l = select(known, l, length_lanes(hit.d));
  const Vec3<D> point = map_point(frame.to_world, p);
  own = p;
  return {point, D(0x1p-44) * (length_lanes(point) + extent), {n.x / l, n.y / l, n.z / l}};
}

/// All but the names of the interaction of a hit that `ray` had with element `i`.
template <class S, bool kWithUv>
SurfaceInteraction exact_interaction(const typename S::Pool& pool, std::size_t i, const Ray& ray,
                                     const Hit& hit) {
  using D = Simd<double, 1, ScalarIsa>;
  Vec3<D> own;
  const SurfacePoints<D> at =
      exact_surface_points<S>(pool, i, D(static_cast<double>(hit.u)), HitPoints<D>(ray, hit.t), own);
  SurfaceInteraction s;
  set_position(s, only_lane(at.point), ray, hit.t, only_lane(at.error));
  s.geometric_normal = s.shading_normal = Vec3f(only_lane(at.normal));
  if constexpr (requires { S::is_smooth(pool, i); }) {
    if (S::is_smooth(pool, i)) {
      const Vec3d g = S::smooth_gradient(pool, i, static_cast<int>(hit.u), only_lane(own));
      const Vec3d n = pool.frames[i].to_own.normal_by_inverse(g);
      if (const double l = length(n); l > 0 && std::isfinite(l)) s.shading_normal = Vec3f(n / l);
    }
  }
  if constexpr (kWithUv) {
    if constexpr (requires { S::uv(pool, i, 0, Vec3d{}); }) {
      const int part = static_cast<int>(hit.u);
      const Vec3d p = only_lane(own);
      set_uv(s, S::uv(pool, i, part, p), slope_at<S>(pool, i, part, p).gradient);
      const Affine& to_world = pool.frames[i].to_world;
      s.tangent = Vec3f(to_world.vector(Vec3d(s.tangent)));
      s.bitangent = Vec3f(to_world.vector(Vec3d(s.bitangent)));
    }
  }
  return s;
}

}  // namespace oktett
