#pragma once
/// \file Random shapes of every kind that a scene can hold, each with what it should be. They are known by
/// names, so that a scene that is read from a file has its oracles back.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "render/scene.h"
#include "verify/cases/kernel_cases.h"
#include "verify/oracles/exact.h"

namespace oktett {

struct KnownShape {
  Shape shape;
  /// In the shape's own space. Without a function `f` for meshes and triangles, whose corners are rounded to
  /// float where they stand.
  ExactOracle truth;

  /// Whether it has an inside, so that it can be combined with others.
  bool is_solid() const { return truth.f != nullptr && truth.where == nullptr; }
};

/// The exact surfaces by the names of their oracles, then the other shapes, then meshes.
const std::vector<std::string>& known_kinds();

/// Shape number `number` of a kind, of a size of about 1 about the origin.
KnownShape draw_known_shape(std::size_t kind, std::uint64_t number);
/// "KIND.NUMBER".
std::string known_name(std::size_t kind, std::uint64_t number);
/// The shape of such a name; nothing for any other name.
std::optional<KnownShape> known_shape(const std::string& name);

// ---- Random scenes of shapes of all kinds.

/// Scene number `number`: up to a dozen objects under random transforms, among them prototypes with instances
/// in them, combinations, and rows of instances; the whole scene may be far away, tiny or huge. Objects that
/// are known shapes have their names, see known_shapes.h.
Scene draw_scene(std::uint64_t number);

}  // namespace oktett
