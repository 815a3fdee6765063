/// \file Fog and rainbows in scene files.

#include <string>

#include "io/mesh/reading.h"
#include "io/scene/readers.h"
#include "io/scene/schema.h"

namespace oktett {

void read_fogs(SceneLoad& load, const YamlNode& list) {
  for (const YamlNode* item : list_items(list, "fog"))
    attempt(*item, [&] {
      Fog fog;
      read_described(load, *item, Fog::kMap, fog);
      load.scene.fogs.push_back(fog);
    });
}

std::string fogs_schema(Schema& schema) { return Schema::list(schema.map(Fog::kMap, Fog{})); }

// ---- Rainbows.

namespace {

/// The colours of a rainbow, by ascending places.
struct RainbowColors {
  std::vector<RainbowColor>& list;
};

void read_value(SceneLoad& load, const YamlNode& node, const Range&, RainbowColors& colors) {
  for (const YamlNode* item : list_items(node, "colors"))
    attempt(*item, [&] {
      RainbowColor color;
      read_described(load, *item, RainbowColor::kMap, color);
      if (!colors.list.empty() && color.at < colors.list.back().at)
        throw Error(item->where(), "the places of colours must ascend");
      colors.list.push_back(color);
    });
  if (colors.list.empty()) throw Error(node.where(), "expected at least one colour");
}

std::string schema_of(Schema& schema, const Range&, const RainbowColors&) {
  return Schema::list(schema.map(RainbowColor::kMap, RainbowColor{}));
}

struct RainbowKeys {
  Rainbow& bow;

  void describe(auto& p) {
    bow.describe(p);
    p.required("colors", RainbowColors{bow.colors}, "from the inner edge to the outer one");
  }
};

}  // namespace

void read_rainbows(SceneLoad& load, const YamlNode& list) {
  for (const YamlNode* item : list_items(list, "rainbow"))
    attempt(*item, [&] {
      Rainbow bow;
      RainbowKeys keys{bow};
      read_described(load, *item, Rainbow::kMap, keys);
      load.scene.rainbows.push_back(std::move(bow));
    });
}

std::string rainbows_schema(Schema& schema) {
  Rainbow usual;
  return Schema::list(schema.map(Rainbow::kMap, RainbowKeys{usual}));
}

void warn_of_fog(Scene& scene) {
  if (!traits(scene.integrator.kind).traces_paths) return;
  const auto warn = [&](const std::string& message) {
    scene.warnings.push_back({Location{scene.source}, message});
  };
  if (!scene.fogs.empty()) warn("fog is for 'whitted' alone, and is left out; 'path' shows a 'medium'");
  if (!scene.rainbows.empty()) warn("rainbows are for 'whitted' alone, and are left out");
  for (const Medium& m : scene.media)
    if (m.density_texture != kNoId || m.phase != PhaseKind::henyey_greenstein || m.fade.distance > 0 ||
        m.extinction != 1)
      warn("medium " + quote_name(m.name) +
           " is for 'whitted': 'path' knows no 'map_density', 'phase', 'fade' and 'extinction'");
}

}  // namespace oktett
