#include "accel/hit_place.h"

#include <algorithm>
#include <cmath>

namespace oktett {

HitPlace follow_path(const Accel& accel, std::uint32_t path) {
  HitPlace place;
  place.accel = &accel;
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
  if (place.moved) place.inverse = place.to_world.inverse();
  return place;
}

void move_surface(const HitPlace& place, const Ray& ray, float t, Surface& s) {
  const Affine& m = place.to_world;
  const Affine& inverse = place.inverse;
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

Ray ray_inside(const HitPlace& place, const Ray& ray) {
  const Affine& inverse = place.inverse;
  return {Vec3f(inverse.point(Vec3d(ray.origin))), ray.tmin, Vec3f(inverse.vector(Vec3d(ray.direction))),
          ray.tmax};
}

HitNames identify_in(const HitPlace& place, const Hit& hit) {
  const Accel& a = *place.accel;
  HitNames names;
  names.geometry = a.geometry_of(hit.item);
  names.primitive = hit.item - a.first_item[names.geometry];
  names.user = place.user != kNoId ? place.user : a.users[names.geometry];
  names.kind = static_cast<Kind>(a.kinds[names.geometry]);
  if (names.kind == Kind::triangle) {
    const auto& slots = std::get<MeshGeometry>(a.geometries[names.geometry].shape).mesh->material_slots;
    if (!slots.empty()) names.material_slot = slots[names.primitive];
  }
  return names;
}

}  // namespace oktett
