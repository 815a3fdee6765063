#include "render/light_groups.h"

#include <fmt/format.h>

#include <algorithm>

namespace oktett {

static std::uint8_t number_of(const std::string& name, std::vector<std::string>& names) {
  if (name.empty()) return 0;
  const auto found = std::find(names.begin(), names.end(), name);
  const auto number = static_cast<std::size_t>(found - names.begin());
  if (number >= kMostLightGroups)
    throw Error(fmt::format("there are more than {} light groups", kMostLightGroups));
  if (found == names.end()) names.push_back(name);
  return static_cast<std::uint8_t>(number);
}

bool is_light_group_name(const std::string& name) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !name.empty() && std::all_of(name.begin(), name.end(), is_plain);
}

LightGroups light_groups(const Scene& scene) {
  LightGroups groups;
  groups.names.emplace_back(kDefaultLightGroup);
  groups.of_light.resize(scene.lights.size());
  for (std::size_t i = 0; i < std::min(scene.lights.size(), scene.light_traits.size()); ++i)
    groups.of_light[i] = number_of(scene.light_traits[i].group, groups.names);
  for (const Material& m : scene.materials)
    groups.of_material.push_back(number_of(m.light_group, groups.names));
  return groups;
}

}  // namespace oktett
