#include "accel/hit_place.h"

#include <algorithm>
#include <cmath>

#include "accel/geometry_bounds.h"
#include "accel/instance.h"

namespace oktett {

static const PathStep& step_of(const Accel& accel, std::uint32_t path) {
  return *(
      std::upper_bound(accel.path_steps.begin(), accel.path_steps.end(), path,
                       [](std::uint32_t value, const PathStep& step) { return value < step.first_path; }) -
      1);
}

std::uint32_t top_item(const Accel& accel, std::uint32_t path) {
  const PathStep& step = step_of(accel, path);
  return step.stride == 0 ? step.item : step.item + (path - step.first_path) / step.stride;
}

/// The instance of a list that path `path` leads through.
static const ListedInstance& listed_instance(const Accel& accel, const PathStep& step, std::uint32_t path) {
  const std::uint32_t g = accel.geometry_of(step.item);
  const std::uint32_t local = (path - step.first_path) / step.stride;
  return accel.listed_instances[accel.index_in_pool(g, local)];
}

HitPlace follow_path(const Accel& accel, std::uint32_t path) {
  HitPlace place;
  place.accel = &accel;
  while (path != kNoId) {
    const PathStep& step = step_of(*place.accel, path);
    const Geometry& g = place.accel->geometries[place.accel->geometry_of(step.item)];
    const std::uint32_t inner = path - step.first_path;
    if (step.stride != 0) {
      const ListedInstance& listed = listed_instance(*place.accel, step, path);
      const Affine to_outer = Affine::from_rows(listed.to_child).inverse();
      place.to_world = place.moved ? place.to_world * to_outer : to_outer;
      place.moved = true;
      path = inner % step.stride - 1;
      if (place.user == kNoId) place.user = listed.user != kNoId ? listed.user : g.user;
      place.accel = place.accel->listed_children[listed.child];
      continue;
    }
    if (step.is_combination) {
      // The solids of a combination already stand where its transform puts them.
      if (place.combined == nullptr) {
        place.combined = step.child;
        if (place.moved) place.to_combined = place.to_world.inverse();
      }
      place.flipped ^= (inner & 1) != 0;
      path = inner / 2 - 1;
    } else {
      place.to_world = place.moved ? place.to_world * g.transform : g.transform;
      place.moved = true;
      path = inner - 1;
    }
    if (place.user == kNoId) place.user = g.user;
    place.accel = step.child;
  }
  if (place.moved) place.inverse = place.to_world.inverse();
  return place;
}

ChainLink outermost_link(const Accel& accel, std::uint32_t chain) {
  const PathStep& step = step_of(accel, chain);
  const std::uint32_t inner = chain - step.first_path;
  ChainLink link{accel.geometry_of(step.item), 0, step.is_combination, step.child, inner - 1};
  if (step.stride != 0) {
    link.primitive = top_item(accel, chain) - accel.first_item[link.geometry];
    link.child = accel.listed_children[listed_instance(accel, step, chain).child];
    link.rest = inner % step.stride - 1;
  } else if (step.is_combination) {
    link.rest = inner / 2 - 1;
  }
  return link;
}

CrossedSolid crossed_solid(const Accel& accel, const Hit& hit) {
  CrossedSolid solid{&accel, kNoId, hit.item, 0};
  std::uint32_t path = hit.instance;
  while (path != kNoId) {
    const PathStep& step = step_of(*solid.accel, path);
    const std::uint32_t inner = path - step.first_path;
    if (step.is_combination) {
      solid.item = step.item;
      break;
    }
    if (step.stride != 0) {
      const ListedInstance& listed = listed_instance(*solid.accel, step, path);
      solid.instance += listed.first_path + 1;
      solid.accel = solid.accel->listed_children[listed.child];
      path = inner % step.stride - 1;
    } else {
      solid.instance += step.first_path + 1;
      solid.accel = step.child;
      path = inner - 1;
    }
  }
  solid.geometry = solid.accel->geometry_of(solid.item);
  if (static_cast<Kind>(solid.accel->kinds[solid.geometry]) == Kind::triangle)
    solid.item = solid.accel->first_item[solid.geometry];
  return solid;
}

Ray moved_ray(const Affine& m, const Ray& ray) {
  return {Vec3f(m.point(Vec3d(ray.origin))), ray.tmin, Vec3f(m.vector(Vec3d(ray.direction))), ray.tmax};
}

Ray ray_inside(const HitPlace& place, const Ray& ray) { return moved_ray(place.inverse, ray); }

// ---- Walks over everything that a structure shows, through all chains of instances.

namespace {

/// Where a structure stands: its space in the world, the number of the chain of instances that ends at it,
/// and the `user` of the outermost instance that has one.
struct Stand {
  Affine to_world;
  std::uint32_t instance = kNoId, user = kNoId;

  std::uint32_t user_or(std::uint32_t inner) const { return user != kNoId ? user : inner; }
};

void visit_structure(const Accel& accel, const Stand& stand,
                     const std::function<void(const PlacedGeometry&)>& visit) {
  for (std::uint32_t g = 0; g < accel.geometries.size(); ++g) {
    const Geometry& geometry = accel.geometries[g];
    if (std::holds_alternative<CsgGeometry>(geometry.shape) ||
        std::holds_alternative<InstanceGeometry>(geometry.shape) ||
        std::holds_alternative<InstanceList>(geometry.shape) || !geometry.transform.is_invertible())
      continue;
    visit({&geometry, stand.to_world * geometry.transform, stand.user_or(accel.users[g]), stand.instance,
           accel.first_item[g]});
  }
  const auto visit_child = [&](const auto& instance, const Affine& to_list, std::uint32_t user) {
    // The number of a chain inside a child follows from that of the child itself as outer_path says.
    const std::uint32_t number = stand.instance + (outer_path(instance, kNoId) + 1);
    visit_structure(child_of(accel, instance), {stand.to_world * to_list, number, stand.user_or(user)},
                    visit);
  };
  const auto geometry_of = [&](const auto& instance) -> const Geometry& {
    return accel.geometries[accel.geometry_of(instance.item)];
  };
  for (const InstanceItem& instance : accel.instances)
    visit_child(instance, geometry_of(instance).transform, geometry_of(instance).user);
  for (const ListedInstance& instance : accel.listed_instances)
    visit_child(instance, Affine::from_rows(instance.to_child).inverse(),
                instance.user != kNoId ? instance.user : geometry_of(instance).user);
}

}  // namespace

void visit_placed_geometries(const Accel& accel, const std::function<void(const PlacedGeometry&)>& visit) {
  visit_structure(accel, {}, visit);
}

}  // namespace oktett
