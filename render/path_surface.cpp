#include "render/path_surface.h"

#include "render/dispersion.h"
#include "render/shading_point.h"

namespace oktett {

// ---- The scattering of a shading point, with directions in world space.

using BsdfFloat = FloatsOf<Bsdf::D>;

static Bsdf bsdf_of(const ShadingPoint& p, const Vec3f& wo) {
  if (p.principled) return principled_bsdf(*p.principled, wo, p.front);
  return phong_bsdf(phong_parameters(p), wo, p.front);
}

static ShadingFrame<Bsdf::D> frame_of(const ShadingPoint& p) {
  ShadingFrame<Bsdf::D> frame(broadcast<BsdfFloat>(p.ns), broadcast<BsdfFloat>(p.ng));
  if (p.principled) frame.turn(p.principled->stretch);
  return frame;
}

SurfaceBsdf::SurfaceBsdf(const ShadingPoint& p)
    : frame_(frame_of(p)),
      bsdf_(bsdf_of(p, only_lane(frame_.to_local(broadcast<BsdfFloat>(-p.direction))))),
      transmits_(bsdf_.transmits()) {}

BsdfValue SurfaceBsdf::evaluate(const Vec3f& l) const {
  const Vec3<BsdfFloat> light = broadcast<BsdfFloat>(l), local = frame_.to_local(light);
  if (none(frame_.agrees(light, local, transmits_))) return {};
  return bsdf_.evaluate(only_lane(local));
}

std::optional<BsdfSample> SurfaceBsdf::sample(float lobe, const SquareSample& u) const {
  BsdfSamples<Bsdf::D> s = bsdf_.samples(lobe, u);
  frame_.to_world(s);
  return only_sample(s);
}

// ---- Surfaces.

PhongParameters phong_parameters(const Material& m) {
  PhongParameters parameters;
  parameters.color = m.color;
  parameters.specular_color = m.specular_color;
  parameters.diffuse = m.diffuse;
  parameters.specular = m.specular;
  parameters.phong = m.phong;
  parameters.reflection = m.reflection;
  parameters.transparency = m.transparency;
  parameters.filter = m.filter;
  parameters.ior = m.ior;
  parameters.brilliance = m.brilliance, parameters.mirror_color = m.reflection_color;
  parameters.specular_blinn = m.specular_blinn, parameters.blinn = m.blinn;
  return parameters;
}

PhongParameters phong_parameters(const ShadingPoint& p) {
  PhongParameters parameters;
  parameters.color = p.color;
  parameters.specular_color = p.specular_color;
  parameters.diffuse = p.values.diffuse;
  parameters.specular = p.values.specular;
  parameters.phong = p.values.phong;
  parameters.reflection = p.values.reflection;
  parameters.transparency = p.values.transparency;
  parameters.filter = p.filter;
  parameters.ior = p.ior;
  parameters.brilliance = p.values.brilliance, parameters.mirror_color = p.reflection_color;
  parameters.specular_blinn = p.values.specular_blinn, parameters.blinn = p.values.blinn;
  return parameters;
}

namespace {

void set_lobes(PathSurface& s, const PhongParameters& parameters, bool front) {
  s.phong = PhongSurface(parameters, front);
  s.transmits = s.phong.transmits();
  s.only_delta = s.phong.only_delta();
}

void set_lobes(PathSurface& s, const PrincipledParameters& parameters, bool front) {
  s.principled = true;
  s.layers = PrincipledSurface(parameters, front);
  s.transmits = s.layers.transmits();
  s.only_delta = s.layers.only_delta();
}

/// Whether its parameters depend on the hit or the path, beside textures.
bool varies_with_hit(const Material& m) {
  if (m.back != kNoId) return true;
  if (!m.principled) return m.reflection_varies;
  const PrincipledParameters& p = m.principled->parameters;
  return p.anisotropy > 0 || disperses(p);
}

PathSurface path_surface(const Material& m, bool front) {
  PathSurface s;
  s.alone = has_textures(m) || m.opacity != 1 || !m.surface || varies_with_hit(m);
  s.glows = glows(m);
  if (front || m.emits_behind) s.emission = m.emission;
  if (s.alone) return s;
  if (m.principled) {
    PrincipledParameters parameters = m.principled->parameters;
    parameters.base_color = m.color;
    set_lobes(s, parameters, front);
  } else {
    set_lobes(s, phong_parameters(m), front);
  }
  return s;
}

}  // namespace

PathSurface path_surface(const ShadingPoint& p) {
  PathSurface s;
  s.glows = glows(*p.material);
  s.emission = p.emission;
  if (p.principled)
    set_lobes(s, *p.principled, p.front);
  else
    set_lobes(s, phong_parameters(p), p.front);
  return s;
}

std::vector<PathSurface> path_surfaces(const World& world) {
  std::vector<PathSurface> surfaces;
  for (const Material& m : world.materials)
    for (const bool front : {true, false}) surfaces.push_back(path_surface(m, front));
  return surfaces;
}

}  // namespace oktett
