#include "kernels/closed/closest.h"

#include <algorithm>
#include <cmath>

#include "kernels/closed/closest_triangle.h"
#include "kernels/closed/polygon.h"

namespace oktett {
namespace {

using Lane = Simd<double, 1, ScalarIsa>;

Vec3d matrix_column(const Affine& a, int k) { return {a.m[0][k], a.m[1][k], a.m[2][k]}; }

/// Takes `other` if it is nearer to p. Where two faces meet, that which faces p more counts, so that the side
/// on which p lies follows from the normal.
void keep_nearer(const Vec3d& p, SurfaceNearest& best, const SurfaceNearest& other) {
  const auto facing = [&](const SurfaceNearest& s) { return std::abs(dot(p - s.point, s.normal)); };
  if (other.d2 < best.d2 || (other.d2 == best.d2 && facing(other) > facing(best))) best = other;
}

SurfaceNearest closest_on_plane(const Vec3d& origin, const Vec3d& n, const Vec3d& p) {
  const double height = dot(n, p - origin);
  return {height * height, p - n * height, n};
}

/// A box whose axes stay perpendicular: `half` are the vectors from the centre to three faces.
SurfaceNearest closest_on_straight_box(const Vec3d& center, const Vec3d (&half)[3], const Vec3d& p) {
  double at[3], size[3], excess[3];
  int axis = 0;
  for (int k = 0; k < 3; ++k) {
    size[k] = length(half[k]);
    at[k] = dot(p - center, half[k] / size[k]);
    excess[k] = std::abs(at[k]) - size[k];
    if (excess[k] > excess[axis]) axis = k;
  }
  const double side = at[axis] < 0 ? -1 : 1;
  const Vec3d normal = half[axis] * (side / size[axis]);
  // From inside only the nearest face counts.
  if (excess[axis] <= 0) return {excess[axis] * excess[axis], p - normal * excess[axis], normal};
  Vec3d point = center;
  double d2 = 0;
  for (int k = 0; k < 3; ++k) {
    point += half[k] * (std::clamp(at[k], -size[k], size[k]) / size[k]);
    if (excess[k] > 0) d2 += excess[k] * excess[k];
  }
  return {d2, point, normal};
}

/// A sheared box: each face is two triangles.
SurfaceNearest closest_on_sheared_box(const BoxShape& box, const Affine& m, const Vec3d& p) {
  SurfaceNearest best;
  const Vec3d center = m.point((box.min + box.max) * 0.5);
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2, i = (axis + 1) % 3, j = (axis + 2) % 3;
    const auto corner = [&](bool high_i, bool high_j) {
      Vec3d q = box.min;
      if (face % 2 == 1) q[axis] = box.max[axis];
      if (high_i) q[i] = box.max[i];
      if (high_j) q[j] = box.max[j];
      return m.point(q);
    };
    const Vec3d a = corner(false, false), c = corner(true, true);
    Vec3d n = normalize(cross(corner(true, false) - a, corner(false, true) - a));
    if (dot(n, a - center) < 0) n = -n;
    for (const Vec3d& b : {corner(true, false), corner(false, true)}) {
      const auto near =
          closest_on_triangle(broadcast<Lane>(p), broadcast<Lane>(a), broadcast<Lane>(b), broadcast<Lane>(c));
      const double u = only_lane(near.u), v = only_lane(near.v);
      keep_nearer(p, best, {only_lane(near.d2), a + (b - a) * u + (c - a) * v, n});
    }
  }
  return best;
}

}  // namespace

SurfaceNearest closest_on(const SphereShape& sphere, const Affine& to_world, const Vec3d& p) {
  const Vec3d center = to_world.point(sphere.center);
  const double radius = sphere.radius * to_world.uniform_scale(), away = length(p - center);
  const Vec3d n = away > 0 ? (p - center) / away : Vec3d{0, 0, 1};
  return {(away - radius) * (away - radius), center + n * radius, n};
}

SurfaceNearest closest_on(const DiskShape& disk, const Affine& to_world, const Vec3d& p) {
  const Vec3d center = to_world.point(disk.center);
  const Vec3d n = normalize(to_world.inverse().normal_by_inverse(disk.normal));
  const double radius = disk.radius * to_world.uniform_scale(), height = dot(n, p - center);
  const Vec3d flat = (p - center) - n * height;
  const double away = length(flat);
  if (away <= radius) return {height * height, p - n * height, n};
  const Vec3d edge = center + flat * (radius / away);
  return {height * height + (away - radius) * (away - radius), edge, n};
}

SurfaceNearest closest_on(const PlaneShape& plane, const Affine& to_world, const Vec3d& p) {
  const Vec3d n = normalize(plane.normal);
  return closest_on_plane(to_world.point(n * plane.offset),
                          normalize(to_world.inverse().normal_by_inverse(n)), p);
}

SurfaceNearest closest_on(const PolygonShape& polygon, const Affine& to_world, const Vec3d& p) {
  const std::size_t count = polygon.vertices.size();
  const Vec3d n = normalize(to_world.inverse().normal_by_inverse(Polygon::area_normal(polygon.vertices)));
  Vec3d centroid{0, 0, 0};
  for (const Vec3d& q : polygon.vertices) centroid += q / static_cast<double>(count);
  const SurfaceNearest foot = closest_on_plane(to_world.point(centroid), n, p);
  const int i = (dominant_axis(n) + 1) % 3, j = (dominant_axis(n) + 2) % 3;
  SurfaceNearest best;
  bool inside = false;
  Vec3d a = to_world.point(polygon.vertices[count - 1]);
  for (const Vec3d& vertex : polygon.vertices) {
    const Vec3d b = to_world.point(vertex);
    const auto edge = closest_on_edge(broadcast<Lane>(p), broadcast<Lane>(a), broadcast<Lane>(b));
    keep_nearer(p, best, {only_lane(edge.d2), a + (b - a) * only_lane(edge.t), n});
    if ((a[j] > foot.point[j]) != (b[j] > foot.point[j]) &&
        foot.point[i] < a[i] + (foot.point[j] - a[j]) / (b[j] - a[j]) * (b[i] - a[i]))
      inside = !inside;
    a = b;
  }
  return inside ? foot : best;
}

SurfaceNearest closest_on(const BoxShape& box, const Affine& to_world, const Vec3d& p) {
  const Vec3d size = (box.max - box.min) * 0.5;
  const Vec3d half[3] = {matrix_column(to_world, 0) * size.x, matrix_column(to_world, 1) * size.y,
                         matrix_column(to_world, 2) * size.z};
  for (int k = 0; k < 3; ++k) {
    const Vec3d &a = half[k], &b = half[(k + 1) % 3];
    if (!(std::abs(dot(a, b)) <= 1e-14 * length(a) * length(b)))
      return closest_on_sheared_box(box, to_world, p);
  }
  return closest_on_straight_box(to_world.point((box.min + box.max) * 0.5), half, p);
}

}  // namespace oktett
