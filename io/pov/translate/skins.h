#pragma once
/// \file Faces of differences that coincide. In POV-Ray they leave a skin, as what is subtracted ends where
/// they lie; here combinations have none, so such faces are moved apart as far as a skin is seen. Within io/
/// only.

#include <memory>
#include <vector>

#include "io/pov/translate/context.h"

namespace oktett::pov {

/// The transforms of the solids of a difference that move such faces apart, an empty one for a solid that
/// stays; none at all if no face can coincide. `solids`: the first one, and what is subtracted from it.
/// `counts`: whether each is a solid that its block describes, not its complement or a surface.
std::vector<Moves> room_for_skins(Context& context, const std::vector<std::shared_ptr<const Block>>& solids,
                                  const std::vector<bool>& counts);

}  // namespace oktett::pov
