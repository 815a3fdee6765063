#pragma once
/// \file Directions that the principled material's facets choose; part of render/bsdf/principled_lobes.h.

#include "render/bsdf/principled_lobes.h"

namespace oktett {

/// Calls scatter(lanes, direction) for the lanes in which rough interfaces are `chosen`.
template <class D>
template <class Scatter>
void PrincipledLobes<D>::sample_facets(const D& chosen, const D& place, const D& x, const D& y,
                                       Scatter&& scatter) const {
  const D zero(0.0);
  const M never = chosen < D(-1.0);
  const M coat = s_->coat_alpha > 0 ? chosen == D(kCoat) : never;
  const M mirror = s_->alpha > 0 ? chosen == D(kMirror) : never;
  const M glass = s_->glass_smooth ? never : chosen == D(kGlass);
  const M again = s_->metal_again_most > 0 ? chosen == D(kMetalAgain) : never;
  const M lanes = coat | mirror | glass | again;
  if (none(lanes)) return;
  const D alpha = select(again, D(s_->again.alpha()), select(coat, D(s_->coat_alpha), D(s_->alpha)));
  const D reflecting = reflecting_bound(wo_, alpha);
  const D bound = s_->thin ? reflecting : select(glass, D(1.0), reflecting);
  const Vec3<D> m = ggx_normal(wo_, alpha, bound, x, y);
  const D c = dot_lanes(wo_, m);
  const Vec3<D> reflected = m * (D(2.0) * c) - wo_;
  const M up = reflected.z > zero;
  M mirrored = coat | mirror | again;
  if (any(glass)) {
    const M reflects = glass & (place < chance_of_reflection(glass_fresnel(c))), passes = glass & ~reflects;
    mirrored = mirrored | reflects;
    if (s_->thin) {
      scatter(passes & up, flipped(reflected));
    } else {
      const D eta(s_->eta), ratio(1 / s_->eta);
      const D cos_behind = sqrt(max(zero, D(1.0) - (D(1.0) - c * c) / (eta * eta)));
      const Vec3<D> wi = m * (c / eta - cos_behind) - wo_ * ratio;
      scatter(passes & (wi.z < zero), wi);
    }
  }
  scatter(mirrored & up, reflected);
}

/// Calls deflect(lanes, direction, coefficient, probability) for the lanes in which smooth interfaces are
/// `chosen`.
template <class D>
template <class Deflect>
void PrincipledLobes<D>::sample_smooth(const D& chosen, const D& place, Deflect&& deflect) const {
  const Vec3<D> mirrored{-wo_.x, -wo_.y, wo_.z};
  const D one(1.0);
  if (const M m = chosen == D(kCoat); s_->coat > 0 && s_->coat_alpha == 0 && any(m))
    deflect(m, mirrored, grey(coat_ * fresnel_lanes(wo_.z, D(s_->coat_eta))), choice_[kCoat]);
  if (const M m = chosen == D(kMirror); s_->alpha == 0 && any(m)) {
    Vec3<D> weight{D(0.0), D(0.0), D(0.0)};
    if (s_->metal > 0) weight = metal_fresnel(wo_.z) * metal_;
    if (s_->opaque > 0) weight = weight + grey(opaque_ * fresnel_lanes(wo_.z, D(s_->opaque_eta)));
    deflect(m, mirrored, weight, choice_[kMirror]);
  }
  const M glass = chosen == D(kGlass);
  if (!s_->glass_smooth || none(glass)) return;
  const D reflectance = glass_fresnel(wo_.z), chance = chance_of_reflection(reflectance);
  const M reflects = place < chance;
  deflect(glass & reflects, mirrored, grey(glass_ * reflectance), choice_[kGlass] * chance);
  Vec3<D> wi = -wo_;
  if (!s_->thin) {
    const D ratio(1 / s_->eta);
    wi.x = wi.x * ratio, wi.y = wi.y * ratio;
    wi.z = -sqrt(max(D(0.0), one - (wi.x * wi.x + wi.y * wi.y)));
  }
  deflect(glass & ~reflects, wi, broadcast<D>(s_->base_color) * (glass_ * (one - reflectance)),
          choice_[kGlass] * (one - chance));
}

template <class D>
Vec3<D> PrincipledLobes<D>::sheen_direction(const D& x, const D& y) const {
  double u[D::kWidth], v[D::kWidth], out[3][D::kWidth];
  x.store(u), y.store(v);
  for (int k = 0; k < D::kWidth; ++k) {
    const Vec3d w = fibres_[k].sample({u[k], v[k]});
    out[0][k] = w.x, out[1][k] = w.y, out[2][k] = w.z;
  }
  return {D::load(out[0]), D::load(out[1]), D::load(out[2])};
}

}  // namespace oktett
