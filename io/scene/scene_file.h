#pragma once
/// \file Scene files (docs/scene-format.md) and meshes given alone.

#include <map>
#include <string>

#include "render/scene.h"

namespace oktett {

/// Values for `${name}` given on the command line as `-D name=value`.
using Definitions = std::map<std::string, std::string>;

/// Reads a YAML scene file with all it includes and all meshes it names. Throws Error with file, line and
/// column.
Scene load_scene_file(const std::string& path, const Definitions& definitions = {});

/// A scene around one mesh file: camera and lights are left to the renderer (camera_given, lights_given =
/// false).
Scene scene_from_mesh(const std::string& path);

/// Chooses by the file's extension: .yaml and .yml are scenes, .obj a mesh; anything else is an error that
/// says so.
Scene load_scene(const std::string& path, const Definitions& definitions = {});

}  // namespace oktett
