#include "render/integrators.h"

#include <algorithm>

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
  }
  return shade_whitted;
}

bool shades_in_blocks(const RenderContext& context) {
  if (context.settings.kind == IntegratorKind::path) return true;
  return context.settings.kind == IntegratorKind::whitted && !context.data_layers;
}

void shade_normal(const RenderContext&, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  wavefront.radiance.set(ray, p.surface.shading_normal * 0.5f + Vec3f{0.5f, 0.5f, 0.5f});
}

void shade_depth(const RenderContext& context, Wavefront& wavefront, std::size_t ray, const ShadingPoint& p) {
  const auto depth = static_cast<float>(camera_depth(context.camera, p.surface.position));
  const float shown = (context.far_depth - depth) / (context.far_depth - context.near_depth);
  const float grey = std::clamp(shown, 0.0f, 1.0f);
  wavefront.radiance.set(ray, {grey, grey, grey});
}

}  // namespace oktett
