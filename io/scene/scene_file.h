#pragma once
/// \file Reading scenes: scene files in YAML, and meshes alone.

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "io/gltf/gltf_options.h"
#include "render/scene.h"

namespace oktett {

/// Values for `${name}` in scene files, by name. They replace those that the file itself states.
using Definitions = std::map<std::string, std::string>;

/// Reads a scene file with all that it includes and all meshes that it names. Image files of textures are not
/// read, see ImageTextures. Throws Error with file, line and column.
Scene load_scene_file(const std::string& path, const Definitions& definitions = {});

/// A scene of one mesh file. Camera and lights are left to render(): camera_given and lights_given are false.
/// A glTF file that has a camera or lights, or shows too many instances for one mesh, is a scene of its own
/// instead.
/// Throws Error as load_obj does.
Scene scene_from_mesh(const std::string& path, const GltfOptions& gltf = {});

/// The film of scenes in POV-Ray's language, which have none: that of the form of their usual camera.
inline const Film kPovFilm = [] {
  Film film;
  film.width = 800, film.height = 600;
  return film;
}();

/// What a scene in POV-Ray's language finds.
struct PovOptions {
  Film film = kPovFilm;  ///< its size
  std::string files;     ///< the only folder whose files its #fopen reads and writes; empty: none
  /// Gets what its #debug, #render and #statistics say; null: it is dropped.
  std::function<void(const std::string&)> said{};
};

/// Calls load_scene_file for .yaml and .yml, reads .pov in POV-Ray's language, and calls scene_from_mesh for
/// mesh files; throws Error for any other extension.
Scene load_scene(const std::string& path, const Definitions& definitions = {});
/// The same with another integrator, if it is given, which is also what is warned of. `gltf`: what is shown
/// of the glTF file that `path` names, or of those that a scene file includes; throws Error for other meshes.
Scene load_scene(const std::string& path, const Definitions& definitions,
                 std::optional<IntegratorKind> integrator, const GltfOptions& gltf = {},
                 const PovOptions& pov = {});

}  // namespace oktett
