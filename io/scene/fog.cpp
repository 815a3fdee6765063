/// \file Fog in scene files.

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

void warn_of_fog(Scene& scene) {
  if (!traits(scene.integrator.kind).traces_paths) return;
  const auto warn = [&](const std::string& message) {
    scene.warnings.push_back({Location{scene.source}, message});
  };
  if (!scene.fogs.empty()) warn("fog is for 'whitted' alone, and is left out; 'path' shows a 'medium'");
  for (const Medium& m : scene.media)
    if (m.density_texture != kNoId || m.phase != PhaseKind::henyey_greenstein || m.fade.distance > 0 ||
        m.extinction != 1)
      warn("medium " + quote_name(m.name) +
           " is for 'whitted': 'path' knows no 'map_density', 'phase', 'fade' and 'extinction'");
}

}  // namespace oktett
