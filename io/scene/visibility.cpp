/// \file Which rays meet an object, and which objects a light lights.

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "io/scene/readers.h"
#include "io/scene/schema.h"
#include "io/yaml/utf8.h"

namespace oktett {

// ---- Kinds of rays.

void read_value(SceneLoad& load, const YamlNode& node, const Range&, RayKindSet& set) {
  set.kinds = 0;
  for (const YamlNode* item : list_items(node, "visible_to"))
    attempt(*item, [&] {
      set.kinds = static_cast<std::uint8_t>(
          set.kinds | bit_of(load.values.choice<RayKind>(*item, std::span(kRayKindNames))));
    });
}

std::string schema_of(Schema&, const Range&, const RayKindSet&) {
  std::vector<std::string> words;
  for (const Choice<RayKind>& kind : kRayKindNames) words.push_back(kind.name);
  return Schema::list(Schema::words(words));
}

// ---- Lists of objects.

void read_value(SceneLoad& load, const YamlNode& node, const Range&, LightListNames& names) {
  NamedList list;
  list.lights_others = names.lights_others;
  for (const YamlNode* item : list_items(node, "the objects of a light"))
    attempt(*item, [&] {
      list.names.push_back(load.values.text(*item));
      list.places.push_back(item->where());
    });
  const auto is_same = [&](const NamedList& other) {
    return other.lights_others == list.lights_others && other.names == list.names;
  };
  const auto found = std::ranges::find_if(load.light_lists, is_same);
  names.list = static_cast<std::uint32_t>(found - load.light_lists.begin());
  if (found != load.light_lists.end()) return;
  if (load.light_lists.size() == kMostLightLists)
    throw Error(node.where(),
                fmt::format("there are more than {} different lists of objects that lights are for",
                            kMostLightLists));
  load.light_lists.push_back(std::move(list));
  load.scene.light_lists.push_back({names.lights_others, node.where()});
}

std::string schema_of(Schema&, const Range&, const LightListNames&) { return Schema::list(Schema::text()); }

namespace {

/// Puts objects on a list.
class ListedObjects {
 public:
  ListedObjects(SceneLoad& load, std::size_t list)
      : load_(load), bit_(static_cast<std::uint16_t>(1u << list)) {}

  void add(const std::string& name, const Location& place) {
    const auto named = load_.named_objects.find(name);
    if (named == load_.named_objects.end()) return add_unregistered(name, place);
    const NamedObjects& objects = named->second;
    if (objects.in_combination)
      throw Error(place, quote(name) + " is in a combination, which is lit as a whole; name the combination");
    std::vector<Object>& all =
        objects.prototype == kNoId ? load_.scene.objects : load_.scene.prototypes[objects.prototype].objects;
    for (std::size_t k = objects.first; k < objects.end; ++k) put(all[k]);
  }

 private:
  void put(Object& object) const { object.listed = static_cast<std::uint16_t>(object.listed | bit_); }

  /// Included files that are no scene files name objects, too.
  void add_unregistered(const std::string& name, const Location& place) {
    bool found = false;
    const auto add_all = [&](std::vector<Object>& objects) {
      for (Object& object : objects)
        if (object.name == name) put(object), found = true;
    };
    add_all(load_.scene.objects);
    for (Prototype& prototype : load_.scene.prototypes) add_all(prototype.objects);
    if (!found) load_.objects.fail_unknown(name, place, "object");
  }

  SceneLoad& load_;
  std::uint16_t bit_;
};

}  // namespace

void resolve_light_lists(SceneLoad& load) {
  for (std::size_t i = 0; i < load.light_lists.size(); ++i) {
    const NamedList& list = load.light_lists[i];
    ListedObjects objects(load, i);
    for (std::size_t k = 0; k < list.names.size(); ++k)
      attempt(load.errors, [&] { objects.add(list.names[k], list.places[k]); });
  }
}

}  // namespace oktett
