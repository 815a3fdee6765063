#include "render/hit_object.h"

#include "accel/hit_place.h"

namespace oktett {

/// The object that geometry `geometry` of a structure shows, the first of several; kNoId if it only holds
/// objects together.
static std::uint32_t object_of_geometry(const World& world, const Accel& accel, std::uint32_t geometry) {
  const auto found = world.structure_objects->find(&accel);
  if (found != world.structure_objects->end()) return found->second[geometry];
  // Else it is the structure of `pose`.
  const std::uint32_t first = world.still != nullptr && stats(*world.still).items > 0 ? 1 : 0;
  return geometry < first ? kNoId : world.moving[geometry - first].instance;
}

/// Calls visit(number, is_combination) for the instances and combinations around a hit, outermost first, by
/// their numbers as objects, until it returns true. Then returns kNoId, else the object whose surface was met
/// if its structure tells.
template <class Visit>
static std::uint32_t visit_objects_around(const World& world, const Hit& hit, const Visit& visit) {
  const Accel* accel = world.accel.get();
  std::uint32_t combination = kNoId;  // the object whose solids `accel` holds
  for (std::uint32_t chain = hit.instance; chain != kNoId;) {
    const ChainLink link = outermost_link(*accel, chain);
    const std::uint32_t first = combination != kNoId ? combination + 1 + link.geometry
                                                     : object_of_geometry(world, *accel, link.geometry);
    if (first != kNoId && visit(first + link.primitive, link.is_combination)) return kNoId;
    combination = link.is_combination ? first : kNoId;
    accel = link.child, chain = link.rest;
  }
  const std::uint32_t geometry = accel->geometry_of(hit.item);
  if (combination != kNoId) return combination + 1 + geometry;
  return world.structure_objects->contains(accel) ? object_of_geometry(world, *accel, geometry) : kNoId;
}

std::uint32_t whole_object(const World& world, const Hit& hit, std::uint32_t user) {
  std::uint32_t whole = user;
  visit_objects_around(world, hit, [&](std::uint32_t number, bool is_combination) {
    const ObjectMaterials& object = world.objects[number];
    if (is_combination || (object.name.empty() && object.material == kNoId)) return false;
    whole = number;
    return true;
  });
  return whole;
}

bool is_shadow_catcher(const World& world, const Hit& hit, std::uint32_t user) {
  bool found = user < world.objects.size() && world.objects[user].shadow_catcher;
  const auto look = [&](std::uint32_t number, bool) {
    return found = found || world.objects[number].shadow_catcher;
  };
  if (found) return true;
  if (const std::uint32_t inner = visit_objects_around(world, hit, look); inner != kNoId) look(inner, false);
  return found;
}

bool is_hollow(const World& world, const Hit& hit, std::uint32_t user) {
  bool hollow = user < world.objects.size() && world.objects[user].hollow;
  if (hollow) return true;
  visit_objects_around(world, hit, [&](std::uint32_t number, bool) {
    return hollow = hollow || world.objects[number].hollow;
  });
  return hollow;
}

std::uint16_t find_light_lists(const World& world, const Hit& hit, std::uint32_t user) {
  unsigned listed = user < world.objects.size() ? world.objects[user].listed : 0u;
  const auto add = [&](std::uint32_t number, bool) {
    listed |= world.objects[number].listed;
    return false;
  };
  // An instance of a material of its own has replaced the number of the object inside.
  if (const std::uint32_t inner = visit_objects_around(world, hit, add); inner != kNoId) add(inner, false);
  return static_cast<std::uint16_t>(listed ^ world.lists_of_others);
}

const Material& material_at(const World& world, const SurfaceInteraction& surface) {
  return world.materials[material_index(world, surface.user, surface.material_slot)];
}

}  // namespace oktett
