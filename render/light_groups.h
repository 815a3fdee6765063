#pragma once
/// \file Light groups: lights that share a name, whose light a picture keeps in a layer of its own.

#include <cstdint>
#include <string>
#include <vector>

#include "render/scene.h"

namespace oktett {

/// The groups of a scene, numbered as they are named first: by its lights, then by its materials. Number 0 is
/// kDefaultLightGroup.
struct LightGroups {
  std::vector<std::string> names;
  std::vector<std::uint8_t> of_light, of_material;  ///< numbered as in Scene

  /// Whether any light is in a group of its own.
  bool any() const { return names.size() > 1; }
  /// That of World::materials[index].
  std::uint8_t material(std::uint32_t index) const {
    return index < of_material.size() ? of_material[index] : std::uint8_t{0};
  }
};

/// Whether layers of a picture can be named after a group of this name: letters, digits, '_' and '-'.
bool is_light_group_name(const std::string& name);

/// Throws Error if there are more than kMostLightGroups.
LightGroups light_groups(const Scene& scene);

}  // namespace oktett
