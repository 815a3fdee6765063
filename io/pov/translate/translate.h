#pragma once
/// \file Scenes in POV-Ray's language as trees of scene files, which io/scene/ reads. Within io/ only.

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/noise_generator.h"
#include "io/pov/document.h"
#include "io/pov/translate/extent.h"
#include "io/yaml/yaml.h"

namespace oktett::pov {

class ObjectQueries;

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
  ObjectQueries* queries = nullptr;         ///< of the document, for heights that are functions; may be null
};

/// Throws Error for what cannot be meant. What scene files do not have is left out with a warning, one for
/// each kind.
TranslatedScene translate(const Document& document, const TranslateOptions& options = {});

/// The noise of the scene's patterns and functions that choose none: what `global_settings` says last, else
/// that of the version.
NoiseGenerator noise_generator_of(const Document& document);

/// One object for questions about its shape.
struct TranslatedObject {
  TranslatedScene scene;  ///< without camera, lights and looks; of warnings only those of the object
  bool is_there = false;  ///< something of it is left
  bool negative = false;  ///< it stands for all but what is in the scene
  Extent extent;          ///< what the statements of the object say of its bounds; infinite if nothing
};

/// `as_solid`: what has no inside is left out, and parts that stand for all but a solid are resolved.
/// `queries` as in TranslateOptions. Throws Error as translate does.
TranslatedObject translate_object(const Document& document, const std::shared_ptr<const Block>& object,
                                  bool as_solid, ObjectQueries* queries = nullptr);

/// A scene of one sphere about the origin that has this block `texture` or `pigment`. Of warnings only those
/// of the look.
TranslatedScene translate_look(const Document& document, const std::shared_ptr<const Block>& look);

}  // namespace oktett::pov
