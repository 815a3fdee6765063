#pragma once
/// \file Objects, groups, prototypes and instances of a scene file. Within io/ only.

#include "io/scene/load.h"

namespace oktett {

/// Adds the prototypes in the map `define` to the scene. Each may hold instances of those before it.
void define_prototypes(SceneLoad& load, const YamlNode& define);

/// Adds the objects in the list `objects` to the scene.
void read_objects(SceneLoad& load, const YamlNode& objects);

}  // namespace oktett
