#pragma once
/// \file The values of `${name}` in a scene file. Within io/ only.

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "io/scene/scene_file.h"
#include "io/yaml/yaml.h"

namespace oktett {

inline constexpr std::size_t kMaxParameters = 1000;       ///< in all files of a scene
inline constexpr std::size_t kMaxExpandedScalar = 16384;  ///< bytes of a scalar after `${}` is replaced

class SceneParameters {
 public:
  explicit SceneParameters(const Definitions& definitions);

  /// Defines the names in the map `params` that have no value yet: what is given first, outermost, wins.
  void add_defaults(const YamlNode& params);

  /// The scalar's text with each `${name}` replaced once by its value, and `$${` by `${`. Throws Error at the
  /// `${` of a name without a value, with the nearest name that has one.
  std::string expand(const YamlNode& scalar);

  /// From here on nothing is said of names without a value: their definitions may be missing.
  void miss_definitions() { incomplete_ = true; }

  /// One warning for each definition on the command line that nothing asked for or overrode.
  std::vector<Warning> unused() const;

 private:
  struct Value {
    std::string text;
    bool from_command_line = false;
    bool used = false;
    bool wrong = false;  ///< where errors are gathered: the definition was
  };

  void add_default(const YamlNode& key, const YamlNode& value);
  const std::string& lookup(const YamlNode& scalar, std::size_t at, const std::string& name);

  std::map<std::string, Value> values_;
  bool incomplete_ = false;
};

}  // namespace oktett
