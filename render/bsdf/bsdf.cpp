#include "render/bsdf/bsdf.h"

namespace oktett {

template <class Lobes>
Bsdf::Kept<Lobes>::Kept(const Surface& s, const Vec3f& wo)
    : surface(s), lobes(surface, broadcast<FloatsOf<D>>(wo)) {}

template struct Bsdf::Kept<PhongLobes<Bsdf::D>>;
template struct Bsdf::Kept<PrincipledLobes<Bsdf::D>>;

BsdfValue Bsdf::evaluate(const Vec3f& wi) const {
  const auto at =
      std::visit([&](const auto& kept) { return kept.lobes.evaluate(broadcast<FloatsOf<D>>(wi)); }, lobes_);
  return {only_lane(at.value), only_lane(at.pdf)};
}

BsdfSamples<Bsdf::D> Bsdf::samples(float lobe, const SquareSample& u) const {
  return std::visit([&](const auto& kept) { return kept.lobes.sample(D(lobe), D(u.x), D(u.y)); }, lobes_);
}

std::optional<BsdfSample> only_sample(const BsdfSamples<Bsdf::D>& s) {
  if (none(s.found)) return std::nullopt;
  return BsdfSample{only_lane(s.direction), only_lane(s.weight), only_lane(s.pdf), only_lane(s.pdf) == 0,
                    any(s.transmitted)};
}

bool Bsdf::chooses_diffuse(float lobe) const {
  return std::visit([&](const auto& kept) { return any(kept.lobes.chooses_diffuse(D(lobe))); }, lobes_);
}

bool Bsdf::only_delta() const {
  return std::visit([](const auto& kept) { return any(kept.lobes.only_delta()); }, lobes_);
}

bool Bsdf::transmits() const {
  return std::visit([](const auto& kept) { return kept.lobes.transmits(); }, lobes_);
}

Bsdf phong_bsdf(const PhongParameters& parameters, const Vec3f& wo, bool front) {
  return {PhongSurface(parameters, front), wo};
}

Bsdf principled_bsdf(const PrincipledParameters& parameters, const Vec3f& wo, bool front) {
  return {PrincipledSurface(parameters, front), wo};
}

}  // namespace oktett
