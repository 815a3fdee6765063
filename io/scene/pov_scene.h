#pragma once
/// \file Scenes in POV-Ray's language, read as scene files.

#include <cstdint>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/scene/scene_file.h"

namespace oktett {

namespace pov {
struct TranslatedScene;
}

/// Whether a name ends like that of a scene in POV-Ray's language: .pov.
bool is_pov_file(const std::string& path);

/// The tree of the scene file that says what such a scene does. `definitions` are declared as numbers or, if
/// they are none, strings before the scene begins. Names of meshes begin with `mesh_prefix`. Throws Error.
pov::TranslatedScene read_pov_tree(const std::string& path, const Definitions& definitions,
                                   const PovOptions& options, const std::string& mesh_prefix = "");

/// What a conversion has written and could not say.
struct PovConversion {
  std::vector<std::string> meshes;  ///< files beside the scene
  std::vector<Warning> warnings;
};

/// Writes a scene in POV-Ray's language as a scene file, its meshes as PLY files beside it. Throws Error.
PovConversion convert_pov(const std::string& input, const std::string& output, const Definitions& definitions,
                          const PovOptions& options = {});

}  // namespace oktett
