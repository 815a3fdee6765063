#include "accel/accel_data.h"
#include "accel/hit_place.h"
#include "accel/surface/mesh_surface.h"
#include "accel/surface/offset_origin.h"
#include "accel/triangle_corners.h"
#include "kernels/exact_ops.h"

namespace oktett {
namespace {

/// uv, dp/du and dp/dv of a mesh hit.
void mesh_uv(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v, const Vec3f (&p)[3],
             SurfaceInteraction& s) {
  const std::array<Vec2f, 3> uv = corner_uvs(mesh, triangle);
  s.uv = weighted_uv(uv, u, v);
  const float du1 = uv[1].x - uv[0].x, dv1 = uv[1].y - uv[0].y, du2 = uv[2].x - uv[0].x,
              dv2 = uv[2].y - uv[0].y;
  const float det = du1 * dv2 - du2 * dv1;
  if (det == 0) return;
  s.tangent = ((p[1] - p[0]) * dv2 - (p[2] - p[0]) * dv1) / det;
  s.bitangent = ((p[2] - p[0]) * du1 - (p[1] - p[0]) * du2) / det;
}

void mesh_interaction(const Geometry& g, const GeometryFrame& g_frame, std::uint32_t triangle, const Hit& hit,
                      SurfaceInteraction& s) {
  using F = Simd<float, 1, ScalarIsa>;
  const TriangleMesh& mesh = *std::get<MeshGeometry>(g.shape).mesh;
  const MeshFrame frame = mesh_frame(g, g_frame);
  Vec3f corners[3], normals[3];
  if (frame.smooth) corner_normals(mesh, triangle, normals);
  Vec3<F> p[3], n[3];
  for (int k = 0; k < 3; ++k) {
    p[k] = place_corner(frame, broadcast<F>(corner_position(mesh, triangle, k)));
    corners[k] = only_lane(p[k]), n[k] = broadcast<F>(normals[k]);
  }
  const MeshSurface<F> surface = mesh_surface(frame, p, n, F(hit.u), F(hit.v));
  s.position = only_lane(surface.position);
  s.position_error = only_lane(surface.position_error);
  s.geometric_normal = only_lane(surface.geometric_normal);
  s.shading_normal = only_lane(surface.shading_normal);
  mesh_uv(mesh, triangle, hit.u, hit.v, corners, s);
}

}  // namespace

SurfaceInteraction identify(const Accel& accel, const Hit& hit) {
  const HitNames names = identify_in(follow_path(accel, hit.instance), hit);
  SurfaceInteraction s;
  s.geometry = names.geometry, s.primitive = names.primitive;
  s.user = names.user, s.material_slot = names.material_slot;
  return s;
}

Affine object_transform(const Accel& accel, const Hit& hit) {
  const HitPlace place = follow_path(accel, hit.instance);
  const std::uint32_t geometry = identify_in(place, hit).geometry;
  const Affine& transform = place.accel->geometries[geometry].transform;
  return place.moved ? place.to_world * transform : transform;
}

/// The surface in the space of the structure that holds the item; `uv` says whether uv and tangents are
/// wanted.
static void interaction_inside(const HitNames& names, const Accel& a, const Ray& inner, const Hit& hit,
                               bool uv, SurfaceInteraction& s) {
  const Geometry& g = a.geometries[names.geometry];
  if (names.kind == Kind::triangle) {
    mesh_interaction(g, a.frames[names.geometry], names.primitive, hit, s);
  } else if (is_exact(names.kind)) {
    const ExactOps& ops = exact_ops(names.kind);
    const std::size_t i = a.index_in_pool(names.geometry, 0);
    (uv ? ops.interaction : ops.interaction_without_uv)(a.exact_pool(names.kind), i, inner, hit, s);
  } else {
    const std::size_t i = a.index_in_pool(names.geometry, names.primitive);
    visit_pool(names.kind, a.pools, [&](auto shape, const auto& pool) {
      closed_interaction<decltype(shape)>(pool, i, inner, hit.t, uv, s);
    });
  }
  s.geometry = names.geometry, s.primitive = names.primitive, s.user = names.user;
  s.material_slot = names.material_slot;
}

void interaction_at(const HitPlace& place, const HitNames& names, const Ray& ray, const Hit& hit, bool uv,
                    SurfaceInteraction& s) {
  if (!place.changes()) return interaction_inside(names, *place.accel, ray, hit, uv, s);
  interaction_inside(names, *place.accel, place.moved ? ray_inside(place, ray) : ray, hit, uv, s);
  move_interaction(place, ray, hit.t, s);
}

SurfaceInteraction surface_interaction(const Accel& accel, const Ray& ray, const Hit& hit) {
  const HitPlace place = follow_path(accel, hit.instance);
  SurfaceInteraction s;
  interaction_at(place, identify_in(place, hit), ray, hit, true, s);
  return s;
}

std::optional<std::array<Vec3f, 3>> triangle_corners(const Accel& accel, const Hit& hit) {
  const HitPlace place = follow_path(accel, hit.instance);
  const HitNames names = identify_in(place, hit);
  if (names.kind != Kind::triangle) return std::nullopt;
  const Geometry& g = place.accel->geometries[names.geometry];
  std::array<Vec3f, 3> corners;
  for (int k = 0; k < 3; ++k)
    corners[k] = Vec3f(place.to_world.point(g.transform.point(
        Vec3d(corner_position(*std::get<MeshGeometry>(g.shape).mesh, names.primitive, k)))));
  return corners;
}

Vec3f offset_origin(const SurfaceInteraction& s, const Vec3f& direction) {
  Vec3f origin;
  offset_origin(s, direction, origin);
  return origin;
}

}  // namespace oktett
