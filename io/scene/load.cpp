#include "io/scene/load.h"

#include <algorithm>

#include "io/yaml/utf8.h"

namespace oktett {

void NameTable::add(const std::string& name, std::uint32_t index, const Location& place,
                    const std::string& what) {
  const auto [taken, is_new] = entries.try_emplace(name, Entry{index, place, false});
  if (is_new) return;
  throw Error(place,
              what + " " + quote(name) + " is defined twice; first at " + to_string(taken->second.where));
}

const NameTable::Entry* NameTable::find(const std::string& name) const {
  const auto found = entries.find(name);
  if (found == entries.end()) return nullptr;
  found->second.used = true;
  return &found->second;
}

void NameTable::fail_unknown(const std::string& name, const Location& place, const std::string& what) const {
  if (incomplete) throw FollowingError();
  throw Error(place, "unknown " + what + " " + quote(name) + suggestion(name));
}

std::string NameTable::suggestion(const std::string& name) const {
  std::vector<std::string> names;
  for (const auto& entry : entries) names.push_back(entry.first);
  std::sort(names.begin(), names.end());
  return suggest(name, names);
}

void SceneLoad::warn_if_unused(const Fields& fields, const char* key, bool is_unused,
                               const std::string& why) {
  const YamlNode* const node = fields[key];
  if (node != nullptr && is_unused) warn(node->where(), quote(key) + " has no effect: " + why);
}

void SceneLoad::warn(const Location& place, const std::string& message) {
  if (!is_clean()) return;
  constexpr std::size_t kMostWarnings = 1000;
  const std::size_t count = scene.warnings.size();
  if (count < kMostWarnings)
    scene.warnings.push_back(Warning{place, message});
  else if (count == kMostWarnings)
    scene.warnings.push_back(Warning{Location{}, "there are more warnings, which are not shown"});
}

void SceneLoad::miss_definitions() {
  media.incomplete = materials.incomplete = prototypes.incomplete = true;
  parameters.miss_definitions();
}

}  // namespace oktett
