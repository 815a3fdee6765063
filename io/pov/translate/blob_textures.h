#pragma once
/// \file Textures of single components of blobs. Within io/ only.

#include <memory>
#include <vector>

#include "io/pov/translate/context.h"

namespace oktett::pov {

/// The field of a component: strength (1 - d^2 / radius^2)^2 at the distance d from a point, or from the line
/// between two, where d < radius.
struct BlobField {
  double strength = 1, radius = 1;
  Vec3d from{}, to{};  ///< the same for a point
  Affine to_own{};     ///< from the space of the blob to that of these
};

/// A component and its look.
struct BlobPart {
  BlobField field;
  std::shared_ptr<const Block> texture;  ///< null: that of the blob
};

/// Whether a component of this block has a look of its own.
bool has_own_texture(const Block& component);
/// Its look, with the transforms that move it.
std::shared_ptr<const Block> texture_of_component(const Block& component);

/// What all parts of `blob` look like together: at each place the mean of their looks, weighted by the
/// magnitudes of their fields. Of very many looks further ones are that of the blob, after a warning. Null if
/// no part has a look of its own.
std::shared_ptr<const Block> blended_texture(Context& context, const Block& blob,
                                             const std::vector<BlobPart>& parts);

}  // namespace oktett::pov
