#pragma once
/// \file Materials and textures of a scene file. Within io/ only.

#include <cstdint>

#include "io/scene/load.h"

namespace oktett {

/// Adds the named materials in the map `materials` to the scene.
void define_materials(SceneLoad& load, const YamlNode& materials);

/// Index into Scene::materials for a name, or for an inline map, which is appended.
std::uint32_t read_material(SceneLoad& load, const YamlNode& node);

}  // namespace oktett
