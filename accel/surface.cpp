#include <algorithm>
#include <cmath>

#include "accel/accel_data.h"
#include "kernels/exact_shapes.h"
#include "kernels/shapes/exact_surface.h"

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
             Surface& s) {
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

Surface mesh_surface(const Geometry& g, const GeometryFrame& frame, const MeshGeometry& shape,
                     std::uint32_t triangle, const Hit& hit) {
  const TriangleMesh& mesh = *shape.mesh;
  const std::uint32_t* index = &mesh.indices[3 * std::size_t{triangle}];
  Vec3f p[3];
  for (int k = 0; k < 3; ++k) {
    p[k] = mesh.positions[index[k]];
    if (!frame.identity) p[k] = Vec3f(g.transform.point(Vec3d(p[k])));
  }
  Surface s;
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
  if (!mesh.material_slots.empty()) s.material_slot = mesh.material_slots[triangle];
  return s;
}

/// Index in the pool of the closed-form item `item`.
template <class Pool>
std::size_t pool_index(const Pool& pool, std::uint32_t item, const std::vector<std::uint32_t>& by_item) {
  const auto at =
      std::lower_bound(by_item.begin(), by_item.end(), item,
                       [&](std::uint32_t index, std::uint32_t value) { return pool.item[index] < value; });
  return *at;
}

/// The structure, geometry chain and transform of a hit.
struct Place {
  const Accel* accel;
  Affine to_world;
  bool moved = false;
  std::uint32_t user = kNoId;
};

/// Follows an instance path to the structure that holds the item.
Place follow_path(const Accel& accel, std::uint32_t path) {
  Place place{&accel, {}, false, kNoId};
  while (path != kNoId) {
    const auto& by_path = place.accel->instances_by_path;
    const auto at = std::upper_bound(by_path.begin(), by_path.end(), path,
                                     [&](std::uint32_t value, std::uint32_t index) {
                                       return value < place.accel->instances[index].first_path;
                                     }) -
                    1;
    const InstanceItem& instance = place.accel->instances[*at];
    const Geometry& g = place.accel->geometries[place.accel->geometry_of(instance.item)];
    place.to_world = place.moved ? place.to_world * g.transform : g.transform;
    place.moved = true;
    if (place.user == kNoId) place.user = g.user;
    path = path - instance.first_path - 1;
    place.accel = instance.child;
  }
  return place;
}

/// Brings a surface found inside an instance to the world.
void move_surface(const Place& place, const Ray& ray, float t, Surface& s) {
  const Affine& m = place.to_world;
  const Affine inverse = m.inverse();
  const Vec3d p = m.point(Vec3d(s.position));
  Vec3f error;
  for (int k = 0; k < 3; ++k) {
    double e = 0x1p-22 * std::abs(p[k]) + 0x1p-22 * std::abs(double(t) * ray.direction[k]);
    for (int j = 0; j < 3; ++j) {
      e += std::abs(m.m[k][j]) * s.position_error[j];
      // The ray's origin and direction were rounded to float inside the instance.
      e += std::abs(m.m[k][j]) * 0x1p-22 * std::abs(s.position[j]);
    }
    error[k] = round_up(e);
  }
  s.position = Vec3f(p);
  s.position_error = error;
  s.geometric_normal = Vec3f(normalize(inverse.normal_by_inverse(Vec3d(s.geometric_normal))));
  s.shading_normal = Vec3f(normalize(inverse.normal_by_inverse(Vec3d(s.shading_normal))));
  s.tangent = Vec3f(m.vector(Vec3d(s.tangent)));
}

Ray ray_inside(const Place& place, const Ray& ray) {
  const Affine inverse = place.to_world.inverse();
  return {Vec3f(inverse.point(Vec3d(ray.origin))), ray.tmin, Vec3f(inverse.vector(Vec3d(ray.direction))),
          ray.tmax};
}

}  // namespace

Surface surface(const Accel& accel, const Ray& ray, const Hit& hit) {
  const Place place = follow_path(accel, hit.instance);
  const Accel& a = *place.accel;
  const std::uint32_t geometry = a.geometry_of(hit.item), local = hit.item - a.first_item[geometry];
  const Geometry& g = a.geometries[geometry];
  const Ray inner = place.moved ? ray_inside(place, ray) : ray;
  Surface s;
  if (const auto* mesh = std::get_if<MeshGeometry>(&g.shape)) {
    s = mesh_surface(g, a.frames[geometry], *mesh, local, hit);
  } else if (std::holds_alternative<ExactShape>(g.shape)) {
    visit_exact(static_cast<Kind>(a.kinds[geometry]), *a.exact,
                [&](auto shape, const auto& pool) { s = exact_surface<decltype(shape)>(pool, hit, inner); });
  } else {
    const Kind kind = static_cast<Kind>(a.kinds[geometry]);
    visit_pool(kind, a.pools, [&](auto shape, const auto& pool) {
      using S = decltype(shape);
      s = S::surface(pool, pool_index(pool, hit.item, a.pool_by_item[static_cast<int>(kind)]), inner, hit.t);
    });
  }
  s.geometry = geometry, s.primitive = local;
  s.user = place.user != kNoId ? place.user : g.user;
  if (place.moved) move_surface(place, ray, hit.t, s);
  return s;
}

Vec3f offset_origin(const Surface& s, const Vec3f& direction) {
  const Vec3f n = s.geometric_normal;
  const float reach = std::abs(n.x) * s.position_error.x + std::abs(n.y) * s.position_error.y +
                      std::abs(n.z) * s.position_error.z;
  const Vec3f offset = n * (dot(direction, n) < 0 ? -reach : reach);
  Vec3f p = s.position + offset;
  for (int k = 0; k < 3; ++k) {
    // The sum is rounded away from the surface.
    if (offset[k] > 0) p[k] = std::nextafter(p[k], std::numeric_limits<float>::infinity());
    if (offset[k] < 0) p[k] = std::nextafter(p[k], -std::numeric_limits<float>::infinity());
  }
  return p;
}

}  // namespace oktett
