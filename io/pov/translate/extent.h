#pragma once
/// \file Boxes around objects, as far as they follow from what the objects say: bounds for surfaces that need
/// some. Within io/ only.

#include <cmath>
#include <memory>
#include <vector>

#include "io/pov/translate/context.h"

namespace oktett::pov {

/// A box, which may be endless.
struct Extent {
  Vec3d lo{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, hi{HUGE_VAL, HUGE_VAL, HUGE_VAL};

  bool is_finite() const;
  Extent meet(const Extent& other) const;
  Extent join(const Extent& other) const;
  /// The box around its image; endless if it is.
  Extent moved(const Affine& map) const;

 private:
  Extent moved_along_axes(const Affine& map) const;
};

/// The box around an object, in the space that it stands in.
Extent extent_of(Context& context, const Block& block);
/// The box around what blocks `keyword`, which is clipped_by or bounded_by, leave of an object, in its space
/// before its transforms.
Extent limits_of(Context& context, const Block& block, std::string_view keyword);

/// The objects that stand in a block.
std::vector<std::shared_ptr<const Block>> objects_in(const Block& block);
/// Whether a block of this keyword is an object.
bool is_object(std::string_view keyword);
/// Whether a word stands in a block.
bool has_word(const Block& block, std::string_view word);

}  // namespace oktett::pov
