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
  bool beyond_bounds = false;  ///< they reach beyond ShapeLimits::bounded, through which alone they are seen
};

/// Boxes about an object, in its own space.
struct ShapeLimits {
  Extent within;             ///< around what is seen of it
  Extent bounded;            ///< around what `bounded_by` names, which is not meant to cut
  bool are_windows = false;  ///< what it names can be looked through: shapes with an inside
};

/// What becomes of a shape.
struct ShapeUse {
  bool operand = false;  ///< of a combination, in which its inside counts
  bool clipped = false;  ///< its surface is cut
};

/// Reads the arguments of an object up to its modifiers. Nothing, after a warning, if scene files have no
/// such shape.
std::optional<Shapes> make_shapes(Context& context, Arguments& arguments, const ShapeLimits& limits,
                                  const ShapeUse& use);

}  // namespace oktett::pov
