#pragma once
/// \file Cameras, lights and what surrounds a scene. Within io/ only.

#include "io/pov/translate/context.h"
#include "io/pov/translate/media.h"

namespace oktett::pov {

/// The value of `camera`. Of a scene without one: `block` is null.
Node camera_node(Context& context, const Block* block);

/// Adds a light. `to_world`: of the union that it stands in. Returns what it looks like, if it says so, which
/// is to be shown without a shadow: a block of an object, and where it goes.
struct LightBody {
  std::shared_ptr<const Block> object;
  Moves moves;
};
LightBody add_light(Context& context, const Block& block, const Affine& to_world);

/// Settings of the whole scene: the sections `integrator`, `background` and `ambient_light`.
struct Surroundings {
  double max_trace_level = 5, adc_bailout = 1 / 255.0;
  Vec3d ambient{1, 1, 1};
  Vec3d background{0, 0, 0};
  std::shared_ptr<const Block> sky;  ///< the last sky_sphere; or null
  Node fogs = nullptr;               ///< a list, if there are some
  Node rainbows = nullptr;           ///< likewise
  Interior interior;                 ///< what else fills the space outside of solids
  Place background_place{}, settings_place{};
};
void read_global_settings(Context& context, const Block& block, Surroundings& surroundings);
void read_background(Context& context, const Block& block, Surroundings& surroundings);

}  // namespace oktett::pov
