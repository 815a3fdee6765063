#include "render/surface_bsdf.h"

namespace oktett {

PhongParameters phong_parameters(const Material& m) {
  PhongParameters parameters;
  parameters.color = m.color, parameters.specular_color = m.specular_color;
  parameters.diffuse = m.diffuse, parameters.specular = m.specular, parameters.phong = m.phong;
  parameters.reflection = m.reflection, parameters.transparency = m.transparency, parameters.ior = m.ior;
  return parameters;
}

static Bsdf bsdf_of(const ShadingPoint& p, const Vec3f& wo) {
  if (p.principled) return principled_bsdf(*p.principled, wo, p.front);
  PhongParameters parameters;
  parameters.color = p.color, parameters.specular_color = p.specular_color;
  parameters.diffuse = p.values.diffuse, parameters.specular = p.values.specular;
  parameters.phong = p.values.phong, parameters.reflection = p.values.reflection;
  parameters.transparency = p.values.transparency, parameters.ior = p.ior;
  return phong_bsdf(parameters, wo, p.front);
}

SurfaceBsdf::Frame::Frame(const Vec3f& n) : z(n) {
  using F = Simd<float, 1, ScalarIsa>;
  Vec3<F> tangent, bitangent;
  basis_lanes(broadcast<F>(n), tangent, bitangent);
  x = only_lane(tangent), y = only_lane(bitangent);
}

SurfaceBsdf::SurfaceBsdf(const ShadingPoint& p)
    : frame_(p.ns),
      ng_(p.ng),
      bsdf_(bsdf_of(p, frame_.to_local(-p.direction))),
      transmits_(p.principled ? p.principled->transmission > 0 : p.values.transparency > 0) {}

BsdfValue SurfaceBsdf::evaluate(const Vec3f& l) const {
  // Both normals must agree on which side the light is.
  const float side = dot(ng_, l);
  const Vec3f local = frame_.to_local(l);
  if (!(side * local.z > 0) || (side < 0 && !transmits_)) return {};
  return bsdf_.evaluate(local);
}

std::optional<BsdfSample> SurfaceBsdf::sample(float lobe, const SquareSample& u) const {
  std::optional<BsdfSample> sample = bsdf_.sample(lobe, u);
  if (!sample) return sample;
  sample->direction = frame_.to_world(sample->direction);
  const float side = dot(ng_, sample->direction);
  if (sample->transmitted ? side < 0 : side > 0) return sample;
  if (!sample->delta) return std::nullopt;
  // Ideal mirrors and glass keep their light: the direction is folded back to its side of the true surface.
  sample->direction = normalize(sample->direction - ng_ * (2 * side));
  return sample;
}

}  // namespace oktett
