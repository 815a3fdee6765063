#include "render/bsdf/phong_lobes.h"

namespace oktett {

static constexpr double kMost = 1e9;

PhongSurface::PhongSurface(const PhongParameters& parameters, bool front)
    : color(limited(parameters.color, 0, kMost)),
      exponent(limited(parameters.phong, 0, kMost)),
      transparency(limited(parameters.transparency, 0, kMost)) {
  const Vec3d specular_color = limited(parameters.specular_color, 0, kMost);
  diffuse = color * limited(parameters.diffuse, 0, kMost);
  highlight = specular_color * limited(parameters.specular, 0, kMost);
  mirror = specular_color * limited(parameters.reflection, 0, kMost);
  const double ior = limited(parameters.ior, 1e-3, 1e3);
  eta = static_cast<float>(front ? ior : 1 / ior);
  only_diffuse = max_component(diffuse) > 0 && highlight == Vec3d{} && mirror == Vec3d{} && transparency == 0;
}

}  // namespace oktett
