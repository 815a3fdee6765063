#include "render/bsdf/bsdf.h"

namespace oktett {

BsdfValue Bsdf::evaluate(const Vec3f& wi) const {
  return std::visit([&](const auto& lobes) { return lobes.evaluate(wi); }, lobes_);
}

std::optional<BsdfSample> Bsdf::sample(float lobe, const SquareSample& u) const {
  return std::visit([&](const auto& lobes) { return lobes.sample(lobe, u); }, lobes_);
}

bool Bsdf::only_delta() const {
  return std::visit([](const auto& lobes) { return lobes.only_delta(); }, lobes_);
}

Bsdf phong_bsdf(const PhongParameters& parameters, const Vec3f& wo, bool front) {
  return Bsdf(PhongLobes(parameters, wo, front));
}

Bsdf principled_bsdf(const PrincipledParameters& parameters, const Vec3f& wo, bool front) {
  return Bsdf(PrincipledLobes(parameters, wo, front));
}

}  // namespace oktett
