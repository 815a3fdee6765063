#pragma once
/// \file Camera, film, integrator and lights of a scene file. Within io/ only.

#include "io/scene/load.h"

namespace oktett {

// Each changes only what its node gives, so that a file overrides what it includes key by key.
void read_camera(SceneLoad& load, const YamlNode& node);
void read_film(SceneLoad& load, const YamlNode& node);
void read_integrator(SceneLoad& load, const YamlNode& node);
/// Adds the lights in a list.
void read_lights(SceneLoad& load, const YamlNode& node);

}  // namespace oktett
