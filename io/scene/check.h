#pragma once
/// \file All that is wrong in a file at once.

#include <cstdint>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/scene/scene_file.h"

namespace oktett {

struct SceneFinding {
  enum class Kind : std::uint8_t { warning, bad_input, io };
  Location where;
  std::string text;  ///< as of Error::what and to_string(Warning)
  Kind kind;
};

struct Findings {
  /// By file, and by line and column in each: first the file that was checked, then those that it names.
  std::vector<SceneFinding> list;
  /// So much is wrong that the rest of the file was not looked at.
  bool has_more = false;
};

/// What is wrong in a scene file, a mesh or an MTL file, and what the reading warns of. Each text is the one
/// that load_scene throws or warns with. Errors that may follow from others are left out, but the first one,
/// which load_scene throws, is always there. Of OBJ files all lines are looked at; other mesh files end at
/// the first error. In scene files it also warns of named materials, media and prototypes that nothing
/// refers to. Throws Error only for wrong names in `definitions`.
Findings check_file(const std::string& path, const Definitions& definitions = {}, const PovOptions& pov = {});

}  // namespace oktett
