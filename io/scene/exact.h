#pragma once
/// \file What exact surfaces in scene files need beside the description of their parameters. Within io/ only.

#include <optional>
#include <string>

#include "io/scene/load.h"
#include "kernels/exact_form.h"

namespace oktett {

/// A shape in a scene file: its key, and the map of its parameters.
struct ShapeNode {
  SceneLoad& load;
  const YamlNode& key;
  const YamlNode& node;
  const Fields& fields;

  /// Warns that the object is left out because of `reason`.
  std::nullopt_t skip(const std::string& reason) const {
    load.warn(key.where(), reason + "; the object is skipped");
    return std::nullopt;
  }
};

// Each checks what the description of the parameters does not say, and reads those that have no member.
// Returns the form, or nothing after a warning if it has no points. Throws Error at the place of what is
// wrong.
std::optional<ExactForm> finish(const ShapeNode& at, PolyhedronShape& shape);
std::optional<ExactForm> finish(const ShapeNode& at, SuperquadricShape& shape);
std::optional<ExactForm> finish(const ShapeNode& at, TurnedProfile& profile);
std::optional<ExactForm> finish(const ShapeNode& at, PrismShape& shape);
std::optional<ExactForm> finish(const ShapeNode& at, TextKeys& keys);
std::optional<ExactForm> finish(const ShapeNode& at, SphereSweepShape& shape);
std::optional<ExactForm> finish(const ShapeNode& at, BezierPatchShape& shape);
std::optional<ExactForm> finish(const ShapeNode& at, ParametricShape& shape);
std::optional<ExactForm> finish(const ShapeNode& at, MetaballsShape& shape);
std::optional<ExactForm> finish(const ShapeNode& at, BlobTreeShape& shape);
std::optional<ExactForm> finish(const ShapeNode& at, JuliaShape& shape);
std::optional<ExactForm> finish(const ShapeNode& at, TerrainShape& shape);
std::optional<ExactForm> finish(const ShapeNode& at, HeightFieldShape& shape);

}  // namespace oktett
