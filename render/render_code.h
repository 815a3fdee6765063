#pragma once
/// \file Code of the renderer that is compiled for each instruction set in render/isa.

#include "core/isa.h"
#include "render/context.h"
#include "render/shading_columns.h"
#include "render/view_directions.h"

namespace oktett {

struct RenderCode {
  void (*view_directions)(const ViewPlane&, const ViewPoints&);
  /// Fills ng and ns.
  void (*face_rays)(const InteractionBlock&, ShadingColumns&);
  /// Fills what the columns say of one light. Needs ng and ns.
  void (*meet_light)(const InteractionBlock&, const LightSource&, ShadingColumns&);
};

template <class A>
const RenderCode& render_code();

/// Throws Error if this build holds no code for the set.
const RenderCode& render_code(Isa isa);

}  // namespace oktett
