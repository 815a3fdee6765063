#include "accel/placed_geometry.h"

#include "accel/accel_data.h"

namespace oktett {
namespace {

/// Where a structure stands: its space in the world, the number of the chain of instances that ends at it,
/// and the `user` of the outermost instance that has one.
struct Stand {
  Affine to_world;
  std::uint32_t instance = kNoId, user = kNoId;

  std::uint32_t user_or(std::uint32_t inner) const { return user != kNoId ? user : inner; }
};

/// Path p inside a child is path first_path + p + 1 outside; p = kNoId is the child itself.
std::uint32_t chain(const Stand& stand, std::uint32_t path) { return stand.instance + path + 1; }

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
  for (const PathStep& step : accel.path_steps) {
    if (step.is_combination || step.stride != 0) continue;
    const Geometry& instance = accel.geometries[accel.geometry_of(step.item)];
    visit_structure(
        *step.child,
        {stand.to_world * instance.transform, chain(stand, step.first_path), stand.user_or(instance.user)},
        visit);
  }
  for (const ListedInstance& place : accel.listed_instances) {
    const Geometry& list = accel.geometries[accel.geometry_of(place.item)];
    visit_structure(
        *accel.listed_children[place.child],
        {stand.to_world * Affine::from_rows(place.to_child).inverse(), chain(stand, place.first_path),
         stand.user_or(place.user != kNoId ? place.user : list.user)},
        visit);
  }
}

}  // namespace

void visit_placed_geometries(const Accel& accel, const std::function<void(const PlacedGeometry&)>& visit) {
  visit_structure(accel, {}, visit);
}

}  // namespace oktett
