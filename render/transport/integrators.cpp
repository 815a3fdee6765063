#include "render/transport/integrators.h"

namespace oktett {

Integrator integrator_for(IntegratorKind kind) {
  switch (kind) {
    case IntegratorKind::whitted:
      return shade_whitted;
    case IntegratorKind::path:
      return shade_path;
    case IntegratorKind::ao:
      return shade_ambient_occlusion;
    case IntegratorKind::normal:
      return shade_normal;
    case IntegratorKind::depth:
      return shade_depth;
    case IntegratorKind::albedo:
      return shade_albedo;
    case IntegratorKind::uv:
      return shade_uv;
    case IntegratorKind::position:
      return shade_position;
    case IntegratorKind::object:
      return shade_object;
    case IntegratorKind::primitive:
      return shade_primitive;
    case IntegratorKind::facing:
      return shade_facing;
    case IntegratorKind::wire:
      return shade_wire;
  }
  return shade_whitted;
}

bool shades_in_blocks(const RenderContext& context) {
  if (context.one_by_one) return false;
  if (context.settings.kind == IntegratorKind::path)
    return context.caustics == nullptr && !context.tracks_enclosures;
  if (context.settings.kind != IntegratorKind::whitted) return false;
  // Lanes know no profiles.
  return std::none_of(context.lights.begin(), context.lights.end(),
                      [](const LightSource& light) { return light.profile.profile != nullptr; });
}

}  // namespace oktett
