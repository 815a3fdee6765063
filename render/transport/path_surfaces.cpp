#include "render/transport/path_surfaces.h"

#include "render/surface_bsdf.h"
#include "render/surface_textures.h"

namespace oktett {

static PathSurface path_surface(const Material& m, bool front) {
  PathSurface s;
  s.alone = has_textures(m) || m.opacity != 1 || !m.surface;
  s.principled = m.principled.has_value();
  s.glows = glows(m);
  if (front || m.emits_behind) s.emission = m.emission;
  if (s.alone) return s;
  if (!s.principled) {
    s.phong = PhongSurface(phong_parameters(m), front);
    s.transmits = m.transparency > 0;
    s.only_delta = s.phong.diffuse == Vec3d{} && s.phong.highlight == Vec3d{};
    return s;
  }
  PrincipledParameters parameters = m.principled->parameters;
  parameters.base_color = m.color;
  s.layers = PrincipledSurface(parameters, front);
  s.transmits = parameters.transmission > 0;
  s.only_delta = s.layers.alpha == 0 && s.layers.opaque == 0 && s.layers.sheen == 0 &&
                 (s.layers.coat == 0 || s.layers.coat_alpha == 0);
  return s;
}

std::vector<PathSurface> path_surfaces(const World& world) {
  std::vector<PathSurface> surfaces;
  for (const Material& m : world.materials)
    for (const bool front : {true, false}) surfaces.push_back(path_surface(m, front));
  return surfaces;
}

}  // namespace oktett
