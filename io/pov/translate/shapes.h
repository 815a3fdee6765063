#pragma once
/// \file Objects of one shape as shapes of scene files. Within io/ only.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/pov/translate/context.h"
#include "io/pov/translate/extent.h"

namespace oktett::pov {

/// What a shape is in a scene file: the key and the value of an object.
struct Shape {
  std::string key;
  Node value = nullptr;
  std::shared_ptr<const Block> texture;  ///< of a part of a mesh; null: that of the object
  Moves first;                           ///< to the space of POV-Ray's object
  bool invisible = false;                ///< it only cuts others
};

/// The parts of an object, mostly one.
struct Shapes {
  std::vector<Shape> parts;
  bool solid = true;  ///< has an inside
  /// Instead of the union of the parts: what they have in common.
  bool meet = false;
};

/// Reads the arguments of an object up to its modifiers. `within`: a box around what is seen of it, in its
/// own space. `operand`: its inside is needed. Nothing, after a warning, if scene files have no such shape.
std::optional<Shapes> make_shapes(Context& context, Arguments& arguments, const Extent& within, bool operand);

}  // namespace oktett::pov
