#pragma once
/// \file Values and densities of the principled material's lobes; part of render/bsdf/principled_lobes.h.

#include "render/bsdf/principled_lobes.h"

namespace oktett {

/// A reflecting lobe of facets, `h` being halfway between both directions: f cos = weight D G / (4 wo.z),
/// with G = 1 / (1 + Lambda(wo) + Lambda(wi)). `chance` is that with which the lobe is chosen.
template <class D>
typename PrincipledLobes<D>::GreyValue PrincipledLobes<D>::facet_lobe(const Facets& f, double alpha,
                                                                      const Vec3<D>& h, const Vec3<D>& wi,
                                                                      const D& weight,
                                                                      const D& chance) const {
  const D normals = ggx_density(h, D(alpha)), lambda = ggx_lambda(wi, D(alpha));
  return {weight * normals / (D(4.0) * wo_.z * (D(1.0) + f.lambda + lambda)), chance * normals * f.reflected};
}

template <class D>
typename PrincipledLobes<D>::Value PrincipledLobes<D>::above(const Vec3<D>& wi) const {
  Value sum;
  const D one(1.0);
  const Vec3<D> h = unit_lanes(wo_ + wi);
  const D c = min(one, dot_lanes(wo_, h));
  if (s_->alpha > 0) {
    // As facet_lobe, for the interfaces that share these facets.
    const D alpha(s_->alpha), normals = ggx_density(h, alpha), density = normals * base_.reflected;
    const D per_area = normals / (D(4.0) * wo_.z);
    Vec3<D> reflectance{D(0.0), D(0.0), D(0.0)};
    if (s_->metal > 0) reflectance = metal_fresnel(c) * metal_;
    if (s_->opaque > 0) reflectance = reflectance + grey(opaque_ * fresnel_lanes(c, D(s_->opaque_eta)));
    sum.pdf = choice_[kMirror] * density;
    if (!s_->glass_smooth) {
      const D f = glass_fresnel(c), visible = per_area / (one + base_.lambda);
      reflectance = reflectance + grey(glass_ * f);
      sum.pdf = sum.pdf + choice_[kGlass] * chance_of_reflection(f) * (s_->thin ? density : visible);
    }
    sum.value = reflectance * (per_area / (one + base_.lambda + ggx_lambda(wi, alpha)));
  }
  if (s_->coat_alpha > 0) {
    const D weight = coat_ * fresnel_lanes(c, D(s_->coat_eta));
    const GreyValue lobe = facet_lobe(coat_facets_, s_->coat_alpha, h, wi, weight, choice_[kCoat]);
    sum.value = sum.value + grey(lobe.value), sum.pdf = sum.pdf + lobe.pdf;
  }
  if (s_->metal_again_most > 0) {
    const D weight = metal_again_ * s_->again.scale(wi.z);
    const GreyValue lobe = facet_lobe(again_facets_, s_->again.alpha(), h, wi, weight, choice_[kMetalAgain]);
    sum.value = sum.value + broadcast<D>(s_->metal_again) * lobe.value, sum.pdf = sum.pdf + lobe.pdf;
  }
  if (s_->opaque > 0) {
    sum.value =
        sum.value + broadcast<D>(s_->base_color) * (diffuse_ * (one - s_->opaque_albedo(wi.z)) * wi.z);
    sum.pdf = sum.pdf + choice_[kDiffuse] * wi.z * D(1 / std::numbers::pi);
  }
  if (any(choice_[kAgainAbove] > D(0.0))) {
    const D loss = one - (s_->thin ? s_->mirror(wi.z) : s_->glass_albedo(wi.z));
    sum.value = sum.value + grey(glass_again_above_ * loss * wi.z);
    const auto some = choice_[kAgainAbove] > D(0.0);
    sum.pdf = sum.pdf + select(some, choice_[kAgainAbove] * grazing_density(wi.z, s_->alpha), D(0.0));
  }
  if (s_->sheen > 0) {
    const D density = sheen_density(wi);
    sum.value = sum.value + broadcast<D>(s_->sheen_color) * (sheen_ * density);
    sum.pdf = sum.pdf + choice_[kSheen] * density;
  }
  return sum;
}

template <class D>
D PrincipledLobes<D>::sheen_density(const Vec3<D>& wi) const {
  double x[D::kWidth], y[D::kWidth], z[D::kWidth], density[D::kWidth];
  wi.x.store(x), wi.y.store(y), wi.z.store(z);
  for (int k = 0; k < D::kWidth; ++k) density[k] = fibres_[k].density({x[k], y[k], z[k]});
  return D::load(density);
}

/// Transmission through facets (Walter 2007), without the factor eta^2 of radiance. Through a thin wall it is
/// reflection with the light on the other side.
template <class D>
typename PrincipledLobes<D>::Value PrincipledLobes<D>::transmitted(const Vec3<D>& wi) const {
  const D one(1.0), zero(0.0), eta(s_->eta), alpha(s_->alpha);
  const Vec3<D> sum = s_->thin ? wo_ + flipped(wi) : wo_ + wi * eta;
  const D size = length_lanes(sum);
  auto seen = size > zero;
  const Vec3<D> h = scale_lanes(sum, one / select(sum.z < zero, -size, size));
  const D c = min(one, dot_lanes(wo_, h)), d = dot_lanes(wi, h);
  const D reflectance = glass_fresnel(c), normals = ggx_density(h, alpha);
  D facing, density;
  if (s_->thin) {
    facing = normals / (D(4.0) * wo_.z);
    density = normals * base_.reflected;
  } else {
    seen = seen & (c > zero) & (d < zero);
    const D t = c + eta * d;
    facing = normals * c / wo_.z * eta * eta * -d / (t * t);
    density = facing / (one + base_.lambda);
  }
  const D shown = facing / (one + base_.lambda + ggx_lambda(wi, alpha));
  const D value = glass_ * (one - reflectance) * shown;
  const D pdf = choice_[kGlass] * (one - chance_of_reflection(reflectance)) * density;
  return {broadcast<D>(s_->base_color) * select(seen, value, zero), select(seen, pdf, zero)};
}

template <class D>
typename PrincipledLobes<D>::Value PrincipledLobes<D>::below(const Vec3<D>& wi) const {
  Value sum = transmitted(wi);
  const D chance = choice_[kAgainBelow], cosine = -wi.z;
  const auto some = chance > D(0.0);
  if (none(some)) return sum;
  const D albedo = s_->thin ? s_->mirror(cosine) : s_->glass_albedo_behind(cosine);
  sum.value = sum.value + broadcast<D>(s_->base_color) *
                              (select(some, glass_again_below_, D(0.0)) * ((D(1.0) - albedo) * cosine));
  sum.pdf = sum.pdf + select(some, chance * grazing_density(cosine, s_->alpha), D(0.0));
  return sum;
}

}  // namespace oktett
