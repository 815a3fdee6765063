#pragma once
/// \file Scenes in POV-Ray's language as trees of scene files, which io/scene/ reads. Within io/ only.

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "io/pov/document.h"
#include "io/yaml/yaml.h"

namespace oktett::pov {

/// A scene as a scene file would say it. Its nodes have the places of the files that it was made of.
struct TranslatedScene {
  std::vector<std::unique_ptr<YamlFile>> files;  ///< that the nodes stand in
  const YamlNode* root = nullptr;
  /// Meshes that stand in the scene itself, by the names of files by which the tree refers to them.
  std::map<std::string, std::shared_ptr<const TriangleMesh>> meshes;
  std::vector<Warning> warnings;  ///< also those of the document
};

struct TranslateOptions {
  std::uint32_t width = 800, height = 600;  ///< of the film
  std::string mesh_prefix;                  ///< names of meshes begin with it
};

/// Throws Error for what cannot be meant. What scene files do not have is left out with a warning, one for
/// each kind.
TranslatedScene translate(const Document& document, const TranslateOptions& options = {});

}  // namespace oktett::pov
