#pragma once
/// \file Normals of POV-Ray, which bend surfaces, as heights. Within io/ only.

#include <memory>
#include <vector>

#include "io/pov/translate/pattern.h"

namespace oktett::pov {

struct Normal;

/// A height of a `slope_map` with how steeply it grows there, or another normal of a `normal_map`.
struct NormalEntry {
  double at = 0, height = 0, slope = 0;
  std::shared_ptr<const Normal> normal;
};

/// What blocks `normal` say, one after the other.
struct Normal {
  PovPattern pattern;
  double amount = 0.5;
  std::vector<NormalEntry> slopes;   ///< by ascending places
  std::vector<NormalEntry> normals;  ///< by ascending places, or in a list
};

/// Reads a normal on top of what is known of it.
void read_normal(Context& context, const Block& block, Normal& normal);

/// Its heights as a texture for `map_bump`; null if it bends nothing, or, after a warning, if scene files
/// have no such pattern. `scale` is that of what it is nested in.
Node normal_node(Context& context, const Normal& normal, double scale = 1);

}  // namespace oktett::pov
