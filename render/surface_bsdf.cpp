#include "render/surface_bsdf.h"

#include "render/path_surface.h"

namespace oktett {

using BsdfFloat = FloatsOf<Bsdf::D>;

static Bsdf bsdf_of(const ShadingPoint& p, const Vec3f& wo) {
  if (p.principled) return principled_bsdf(*p.principled, wo, p.front);
  return phong_bsdf(phong_parameters(p), wo, p.front);
}

SurfaceBsdf::SurfaceBsdf(const ShadingPoint& p)
    : frame_(broadcast<BsdfFloat>(p.ns), broadcast<BsdfFloat>(p.ng)),
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

}  // namespace oktett
