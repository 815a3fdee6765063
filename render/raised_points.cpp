#include "render/raised_points.h"

#include <algorithm>

#include "accel/hit_place.h"
#include "render/shading_lanes.h"

namespace oktett {
namespace {

/// The vector from a point of a triangle, of barycentric coordinates u and v, to the raised point: the mean,
/// weighted as normals are, of the ways to the tangent planes at the corners, as far as these lie above the
/// point. `side` is 1 if the normals point to the side where that is, else -1.
Vec3d raise(const SmoothTriangle& triangle, const Vec3d& position, double u, double v, double side) {
  const double weight[3] = {1 - u - v, u, v};
  Vec3d sum;
  for (int k = 0; k < 3; ++k) {
    const Vec3d n = triangle.normal[k] * side;
    sum += n * (weight[k] * std::max(0.0, dot(triangle.corner[k] - position, n)));
  }
  return sum;
}

}  // namespace

RaisedPoints::RaisedPoints(const Accel& accel, const RaySpan& rays, const HitSpan& hits,
                           const std::uint32_t* which, const InteractionBlock& found, Isa isa)
    : accel_(accel), rays_(rays), hits_(hits), which_(which), found_(found), isa_(isa) {}

RaisedPoints::State RaisedPoints::find(std::size_t k) {
  using F = Simd<float, 1, ScalarIsa>;
  const SurfaceInteraction s = found_[k];
  if (s.shading_normal == s.geometric_normal) return State::none;
  const Hit hit = hits_[which_[k]];
  const std::optional<SmoothTriangle> triangle = smooth_triangle(accel_, hit);
  if (!triangle) return State::none;
  Vec3<F> ng, ns;
  face_ray(broadcast<F>(rays_[which_[k]].direction), broadcast<F>(s.geometric_normal),
           broadcast<F>(s.shading_normal), ng, ns);
  normal_[k] = only_lane(ns);
  const Vec3f up = only_lane(ng);
  // A combination of solids may turn the shading normal round.
  const double u = hit.u, v = hit.v;
  const Vec3d n = triangle->normal[0] * (1 - u - v) + triangle->normal[1] * u + triangle->normal[2] * v;
  const Vec3f way(raise(*triangle, Vec3d(s.position), u, v, dot(n, Vec3d(up)) < 0 ? -1 : 1));
  if (!(dot(way, up) > 0) || !is_finite(way)) return State::none;
  // The ray looks twice as far as the point is raised, so that the point lies at most halfway to what it
  // meets.
  const Ray above{offset_origin(s, up), 0, way, 2};
  const Hit met = closest_hit(accel_, above, isa_);
  point_[k] = above.origin + way * (met.valid() ? met.t / 2 : 1.0f);
  return State::raised;
}

const Vec3f* RaisedPoints::point(std::size_t k) {
  if (state_[k] == State::unknown) state_[k] = find(k);
  return state_[k] == State::raised ? &point_[k] : nullptr;
}

bool RaisedPoints::leads_above(std::size_t k, const Vec3f& direction) const {
  return dot(normal_[k], direction) > 0;
}

const Vec3f* RaisedPoints::origin(std::size_t k, const Vec3f& direction) {
  const Vec3f* const raised = point(k);
  return raised != nullptr && leads_above(k, direction) ? raised : nullptr;
}

}  // namespace oktett
