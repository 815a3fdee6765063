#include "accel/placed_geometry.h"

#include "accel/instance.h"

namespace oktett {
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
