#pragma once
/// \file What fills the space around a scene. Within io/ only.

#include "io/pov/translate/context.h"

namespace oktett::pov {

/// The item of `fog` that a block `fog` means; null if nothing is seen of it.
Node fog_node(Context& context, const Block& block);
/// The item of `rainbow` that a block `rainbow` means; null, after a warning, if nothing is seen of it.
Node rainbow_node(Context& context, const Block& block);

}  // namespace oktett::pov
