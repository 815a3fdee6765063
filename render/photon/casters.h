#pragma once
/// \file Which surfaces make caustics, and where they are.

#include "core/box.h"
#include "render/geometry.h"

namespace oktett {

/// Whether path tracing may send light from the material in ideal mirror or refracted directions.
bool may_cast(const Material& material);

/// The surfaces that may send light on in ideal directions.
struct Casters {
  Box bounds;              ///< of those that have bounds; empty if there are none
  bool unbounded = false;  ///< some have none

  bool none() const { return bounds.empty() && !unbounded; }
};

/// Geometries count as a whole: an instance that shows one mirror has the bounds of all that it shows.
Casters find_casters(const World& world);

}  // namespace oktett
