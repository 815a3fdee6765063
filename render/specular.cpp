#include "render/specular.h"

#include "render/bsdf/optics.h"

namespace oktett {

/// The refracted direction. It must lead below the true surface: if refraction by the shading normal leads
/// above, the geometric normal is used.
static std::optional<Vec3f> refract_below(const ShadingPoint& p, float eta) {
  const std::optional<Vec3f> direction = refract(p.direction, p.ns, eta);
  if (direction && dot(*direction, p.ng) >= 0) return refract(p.direction, p.ng, eta);
  return direction;
}

SpecularRays specular_rays(const ShadingPoint& p) {
  SpecularRays rays;
  const PhongValues& v = p.values;
  if (v.reflection == 0 && v.transparency == 0) return rays;
  rays.mirror_direction = reflect_above(p.direction, p.ns, p.ng);
  rays.mirror = p.specular_color * v.reflection;
  if (v.transparency == 0) return rays;
  const float eta = p.front ? p.ior : 1 / p.ior;
  const std::optional<Vec3f> refracted = refract_below(p, eta);
  const float reflectance = refracted ? fresnel(-dot(p.direction, p.ns), eta) : 1;
  const float mirrored = v.transparency * reflectance;
  rays.mirror += Color{mirrored, mirrored, mirrored};
  if (refracted) {
    rays.refracted_direction = *refracted;
    rays.refracted = p.color * (v.transparency * (1 - reflectance));
  }
  return rays;
}

}  // namespace oktett
