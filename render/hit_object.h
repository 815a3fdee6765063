#pragma once
/// \file The object at a hit, and what is true of it and of the instances and combinations around it.

#include <algorithm>
#include <cstdint>

#include "render/geometry.h"

namespace oktett {

/// Whether the object at a hit, or an instance or a combination around it, is a shadow catcher. `user` is
/// that of the hit's surface interaction.
bool is_shadow_catcher(const World& world, const Hit& hit, std::uint32_t user);

/// Whether the object at a hit, or an instance around it, is hollow. `user` as before.
bool is_hollow(const World& world, const Hit& hit, std::uint32_t user);

/// Which lists of lights light the object at a hit, as LightPoint::lists: lists that name it, or an instance
/// or a combination around it, and those of LightList::lights_others that do not. `user` is that of the hit's
/// surface interaction.
std::uint16_t find_light_lists(const World& world, const Hit& hit, std::uint32_t user);
/// The same; all, without the search, if the scene has none.
inline std::uint16_t light_lists_at(const World& world, const Hit& hit, std::uint32_t user) {
  return world.has_light_lists ? find_light_lists(world, hit, user) : std::uint16_t{0xffff};
}

/// Whether the light that an object emits, `user` as before, is for a point of these lists.
inline bool lights(const World& world, std::uint32_t user, std::uint16_t lists) {
  if (!world.has_light_lists || user >= world.objects.size()) return true;
  const std::uint32_t list = world.objects[user].light_list;
  return list >= kMostLightLists || (lists >> list & 1) != 0;
}

/// The object that counts as a whole at a hit: the outermost instance that has a name or a material of its
/// own, else the object whose surface was met. `user` is that of the hit's surface interaction.
std::uint32_t whole_object(const World& world, const Hit& hit, std::uint32_t user);

/// The material at a hit: that of the object, else of the mesh's slot, else the default material.
const Material& material_at(const World& world, const SurfaceInteraction& surface);
/// Its index in World::materials.
inline std::uint32_t material_index(const World& world, std::uint32_t user, std::uint32_t material_slot) {
  std::uint32_t material = kNoId;
  if (user < world.objects.size()) {
    const ObjectMaterials& object = world.objects[user];
    material = object.material;
    if (material == kNoId && material_slot < object.slots.size()) material = object.slots[material_slot];
  }
  return std::min(material, static_cast<std::uint32_t>(world.materials.size() - 1));
}

}  // namespace oktett
