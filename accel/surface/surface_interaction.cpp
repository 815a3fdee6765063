#include <algorithm>
#include <cmath>
#include <new>

#include "accel/accel_data.h"
#include "accel/hit_place.h"
#include "accel/surface/offset_origin.h"
#include "kernels/exact_shapes.h"
#include "kernels/exact_surface.h"

namespace oktett {
namespace {

/// Interpolated normal of a mesh hit, or zero if a corner has none.
Vec3f mesh_normal(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v) {
  if (mesh.normal_indices.empty()) return {};
  const std::uint32_t* index = &mesh.normal_indices[3 * std::size_t{triangle}];
  if (index[0] == kNoId || index[1] == kNoId || index[2] == kNoId) return {};
  return mesh.normals[index[0]] * (1 - u - v) + mesh.normals[index[1]] * u + mesh.normals[index[2]] * v;
}

/// uv and dp/du of a mesh hit; a mesh without texture coordinates has the barycentric ones.
void mesh_uv(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v, const Vec3f (&p)[3],
             SurfaceInteraction& s) {
  Vec2f uv[3] = {{0, 0}, {1, 0}, {0, 1}};
  if (!mesh.uv_indices.empty()) {
    const std::uint32_t* index = &mesh.uv_indices[3 * std::size_t{triangle}];
    if (index[0] != kNoId && index[1] != kNoId && index[2] != kNoId)
      for (int k = 0; k < 3; ++k) uv[k] = mesh.uvs[index[k]];
  }
  const float w = 1 - u - v;
  s.uv = {uv[0].x * w + uv[1].x * u + uv[2].x * v, uv[0].y * w + uv[1].y * u + uv[2].y * v};
  const float du1 = uv[1].x - uv[0].x, dv1 = uv[1].y - uv[0].y, du2 = uv[2].x - uv[0].x,
              dv2 = uv[2].y - uv[0].y;
  const float det = du1 * dv2 - du2 * dv1;
  if (det != 0) s.tangent = ((p[1] - p[0]) * dv2 - (p[2] - p[0]) * dv1) / det;
}

SurfaceInteraction mesh_surface(const Geometry& g, const GeometryFrame& frame, const MeshGeometry& shape,
                                std::uint32_t triangle, const Hit& hit) {
  const TriangleMesh& mesh = *shape.mesh;
  const std::uint32_t* index = &mesh.indices[3 * std::size_t{triangle}];
  Vec3f p[3];
  for (int k = 0; k < 3; ++k) {
    p[k] = mesh.positions[index[k]];
    if (!frame.identity) p[k] = Vec3f(g.transform.point(Vec3d(p[k])));
  }
  SurfaceInteraction s;
  const float w = 1 - hit.u - hit.v;
  s.position = p[0] * w + p[1] * hit.u + p[2] * hit.v;
  for (int k = 0; k < 3; ++k) {
    // gamma(7) bounds the interpolation's rounding (Pharr, Jakob, Humphreys 2016, section 3.9.4); the
    // weights, rounded to float, add two more units.
    const float magnitude = std::abs(p[0][k] * w) + std::abs(p[1][k] * hit.u) + std::abs(p[2][k] * hit.v);
    const float spread = std::abs(p[1][k] - p[0][k]) + std::abs(p[2][k] - p[0][k]);
    s.position_error[k] = 0x1p-21f * magnitude + 0x1p-22f * spread + 1e-37f;
  }
  const Vec3d n = cross(Vec3d(p[1]) - Vec3d(p[0]), Vec3d(p[2]) - Vec3d(p[0]));
  // A mirroring transform turns the winding around, but not the outside.
  const double side = frame.mirrored ? -1 : 1;
  s.geometric_normal = s.shading_normal = Vec3f(normalize(n) * side);
  if (shape.smooth) {
    Vec3d ns = Vec3d(mesh_normal(mesh, triangle, hit.u, hit.v));
    if (!frame.identity) ns = frame.inverse.normal_by_inverse(ns);
    const double l = length(ns);
    if (l > 0 && std::isfinite(l)) s.shading_normal = Vec3f(ns / l);
  }
  mesh_uv(mesh, triangle, hit.u, hit.v, p, s);
  return s;
}

}  // namespace

SurfaceInteraction identify(const Accel& accel, const Hit& hit) {
  const HitNames names = identify_in(follow_path(accel, hit.instance), hit);
  SurfaceInteraction s;
  s.geometry = names.geometry, s.primitive = names.primitive;
  s.user = names.user, s.material_slot = names.material_slot;
  return s;
}

/// Makes a surface in its place: a copy would read whole registers of what was just written number by number,
/// for which processors wait.
template <class Function>
static void make_in_place(SurfaceInteraction& s, const Function& make) {
  ::new (static_cast<void*>(&s)) SurfaceInteraction(make());
}

/// The surface inside the structure that holds the item; `uv` says whether uv and tangent are wanted.
static void surface_inside(const HitNames& names, const Accel& a, const Ray& inner, const Hit& hit, bool uv,
                           SurfaceInteraction& s) {
  const Geometry& g = a.geometries[names.geometry];
  if (const auto* mesh = std::get_if<MeshGeometry>(&g.shape)) {
    s = mesh_surface(g, a.frames[names.geometry], *mesh, names.primitive, hit);
  } else if (std::holds_alternative<ExactShape>(g.shape)) {
    visit_exact(names.kind, *a.exact, [&](auto shape, const auto& pool) {
      using S = decltype(shape);
      const std::size_t i = a.pool_index[a.first_pool_index[names.geometry]];
      s = uv ? exact_surface<S>(pool, i, hit, inner) : exact_surface_without_uv<S>(pool, i, hit, inner);
    });
  } else {
    visit_pool(names.kind, a.pools, [&](auto shape, const auto& pool) {
      using S = decltype(shape);
      const std::size_t i = a.pool_index[a.first_pool_index[names.geometry] + names.primitive];
      if constexpr (requires { S::interaction_without_uv(pool, i, inner, hit.t); }) {
        if (uv)
          make_in_place(s, [&] { return S::interaction(pool, i, inner, hit.t); });
        else
          make_in_place(s, [&] { return S::interaction_without_uv(pool, i, inner, hit.t); });
      } else {
        make_in_place(s, [&] { return S::interaction(pool, i, inner, hit.t); });
      }
    });
  }
  s.geometry = names.geometry, s.primitive = names.primitive, s.user = names.user;
  s.material_slot = names.material_slot;
}

void surface_at(const HitPlace& place, const HitNames& names, const Ray& ray, const Hit& hit, bool uv,
                SurfaceInteraction& s) {
  if (!place.changes()) return surface_inside(names, *place.accel, ray, hit, uv, s);
  surface_inside(names, *place.accel, place.moved ? ray_inside(place, ray) : ray, hit, uv, s);
  move_surface(place, ray, hit.t, s);
}

SurfaceInteraction surface_interaction(const Accel& accel, const Ray& ray, const Hit& hit) {
  const HitPlace place = follow_path(accel, hit.instance);
  SurfaceInteraction s;
  surface_at(place, identify_in(place, hit), ray, hit, true, s);
  return s;
}

Vec3f offset_origin(const SurfaceInteraction& s, const Vec3f& direction) {
  Vec3f origin;
  offset_origin(s, direction, origin);
  return origin;
}

}  // namespace oktett
