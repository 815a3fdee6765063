#pragma once
/// \file What is known while a scene file is read. Within io/ only.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "io/gltf/gltf_options.h"
#include "io/obj/mtl_texture.h"
#include "io/scene/meshes.h"
#include "io/scene/parameters.h"
#include "io/scene/values.h"
#include "render/scene.h"

namespace oktett {

/// Most spheres in a scene, and most bytes of sphere files, each file counted as often as it is named.
inline constexpr std::size_t kMaxSpheres = std::size_t{1} << 25;
inline constexpr std::size_t kMaxSphereFileBytes = std::size_t{1} << 30;
/// Most levels of instances inside prototypes.
inline constexpr int kMaxInstanceLevels = 32;

/// Names of one kind and where each was given.
struct NameTable {
  struct Entry {
    std::uint32_t index;
    Location where;
    mutable bool used = false;  ///< was looked for
  };
  std::unordered_map<std::string, Entry> entries;
  bool incomplete = false;  ///< where errors are gathered: names may be missing because of one

  /// Throws Error at `place` if `name` is taken; `what` is the kind of thing, e.g. "material".
  void add(const std::string& name, std::uint32_t index, const Location& place, const std::string& what);
  const Entry* find(const std::string& name) const;
  /// Throws Error at `place`: there is no such name.
  [[noreturn]] void fail_unknown(const std::string& name, const Location& place,
                                 const std::string& what) const;
  /// "; did you mean 'x'?" or nothing.
  std::string suggestion(const std::string& name) const;
};

/// The objects that a name in a scene file stands for: those from `first` up to `end` of the world, or of a
/// prototype.
struct NamedObjects {
  std::uint32_t prototype = kNoId;  ///< index into Scene::prototypes; kNoId: the world
  std::size_t first = 0, end = 0;
  bool in_combination = false;  ///< it stands for an operand instead
};

/// The names that a list of lights gives.
struct NamedList {
  bool lights_others = false;
  std::vector<std::string> names;
  std::vector<Location> places;  ///< of the names
};

/// The textures that a pattern shows.
struct NestedPattern {
  unsigned depth = 0;     ///< the longest chain of patterns in patterns, itself included
  std::size_t count = 1;  ///< all of them, as often as each is shown
};

struct SceneLoad {
  explicit SceneLoad(const Definitions& given) : definitions(given), parameters(given), values(parameters) {}
  SceneLoad(const SceneLoad&) = delete;
  SceneLoad& operator=(const SceneLoad&) = delete;

  Scene scene;
  const Definitions definitions;
  PovOptions pov;  ///< of scenes in POV-Ray's language
  SceneParameters parameters;
  SceneValues values;
  MeshLibrary meshes;
  NameTable media, materials, prototypes, objects;
  TextureList textures{scene.textures};
  std::optional<IntegratorKind> integrator;  ///< instead of that of the file
  GltfOptions gltf;                          ///< of included glTF files
  std::set<std::string> light_groups;        ///< names that lights and materials have given
  std::unordered_map<std::string, NamedObjects> named_objects;
  std::map<std::uint32_t, NestedPattern> patterns;  ///< by their index among the textures
  std::vector<NamedList> light_lists;               ///< of Scene::light_lists
  std::vector<int> prototype_levels;                ///< of instances, its own included, per prototype
  std::vector<bool> prototype_hides;  ///< per prototype: not all that it shows is visible to all rays
  std::size_t spheres = 0, sphere_file_bytes = 0;
  ErrorList* errors = nullptr;  ///< where errors are gathered; null: the first one is thrown

  /// Adds a warning; after the first thousand only says that there are more. Where errors are gathered, says
  /// nothing of what is known to be wrong.
  void warn(const Location& place, const std::string& message);
  /// Warns that `key` changes nothing, if it is one of the fields and `is_unused`.
  void warn_if_unused(const Fields& fields, const char* key, bool is_unused, const std::string& why);
  /// Whether nothing is known to be wrong in what is being read.
  bool is_clean() const { return errors == nullptr || errors->is_clean(); }
  /// Where errors are gathered: definitions may be missing, so that nothing is said of unknown names.
  void miss_definitions();
};

}  // namespace oktett
