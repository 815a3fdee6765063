#pragma once
/// \file The weights of the principled material's lobes for a viewer; part of render/bsdf/principled_lobes.h.

#include "render/bsdf/principled_lobes.h"

namespace oktett {

/// Sheen and coat, and the weights of what lies below.
template <class D>
void PrincipledLobes<D>::set_layers() {
  D left(1.0);
  if (s_->sheen > 0) {
    double x[D::kWidth], y[D::kWidth], z[D::kWidth], albedo[D::kWidth];
    wo_.x.store(x), wo_.y.store(y), wo_.z.store(z);
    for (int k = 0; k < D::kWidth; ++k) {
      fibres_[k] = SheenLobe({x[k], y[k], z[k]}, s_->sheen_roughness);
      albedo[k] = fibres_[k].albedo();
    }
    sheen_ = D::load(albedo);
    choice_[kSheen] = D(s_->sheen) * sheen_;
    left = left - choice_[kSheen];
  }
  if (s_->coat > 0) {
    coat_ = left * D(s_->coat);
    coat_facets_ = facets(s_->coat_alpha);
    choice_[kCoat] = coat_ * s_->coat_albedo(wo_.z);
    left = left - choice_[kCoat];
  }
  metal_ = left * D(s_->metal), opaque_ = left * D(s_->opaque), glass_ = left * D(s_->glass);
}

template <class D>
void PrincipledLobes<D>::set_metal() {
  const Vec3<D> reflected = metal_fresnel(wo_.z);
  // At least a little, since black metal is black head-on and white at grazing angles.
  choice_[kMirror] =
      choice_[kMirror] + metal_ * max(D(0.02), max(max(reflected.x, reflected.y), reflected.z));
  if (!(s_->metal_again_most > 0)) return;
  again_facets_ = facets(s_->again.alpha());
  metal_again_ = metal_ * s_->again.scale(wo_.z);
  choice_[kMetalAgain] = metal_ * (D(1.0) - s_->mirror(wo_.z)) * D(s_->metal_again_most);
}

/// An interface over Lambert's law. The diffuse part takes what the interface does not reflect, for the
/// light's direction and for the viewer's (Kelemen 2001).
template <class D>
void PrincipledLobes<D>::set_opaque() {
  const D reflected = s_->opaque_albedo(wo_.z), left = opaque_ * (D(1.0) - reflected);
  choice_[kMirror] = choice_[kMirror] + opaque_ * max(D(s_->opaque_head_on), reflected);
  diffuse_ = left * D(1 / (std::numbers::pi * s_->opaque_albedo.mean_loss()));
  choice_[kDiffuse] = left * D(s_->tint);
}

template <class D>
void PrincipledLobes<D>::set_glass() {
  const D reflectance = glass_fresnel(wo_.z);
  choice_[kGlass] = glass_ * max(D(0.02), reflectance + (D(1.0) - reflectance) * D(s_->tint));
  if (s_->glass_smooth || !(s_->loss > 0 && s_->loss_behind > 0)) return;
  const D albedo = s_->thin ? s_->mirror(wo_.z) : s_->glass_albedo(wo_.z);
  const D lost = glass_ * (D(1.0) - albedo), above = lost * D(1 - s_->passed), below = lost * D(s_->passed);
  glass_again_above_ = above * D(1 / (std::numbers::pi * s_->loss));
  glass_again_below_ = below * D(1 / (std::numbers::pi * s_->loss_behind));
  choice_[kAgainAbove] = choice_[kAgainAbove] + above;
  choice_[kAgainBelow] = below * D(s_->tint);
}

template <class D>
Vec3<D> PrincipledLobes<D>::metal_fresnel(const D& c) const {
  if (!s_->has_conductor) return schlick(s_->base_color, c);
  const Vec3d &eta = s_->conductor_eta, &k = s_->conductor_k;
  return {conductor_fresnel_lanes(c, eta.x, k.x), conductor_fresnel_lanes(c, eta.y, k.y),
          conductor_fresnel_lanes(c, eta.z, k.z)};
}

/// Of a thin wall: with all reflections inside it.
template <class D>
D PrincipledLobes<D>::glass_fresnel(const D& c) const {
  const D f = min(D(1.0), fresnel_lanes(c, D(s_->eta)));
  return s_->thin ? D(2.0) * f / (D(1.0) + f) : f;
}

/// Of a sample of glass.
template <class D>
D PrincipledLobes<D>::chance_of_reflection(const D& reflectance) const {
  const D passed = (D(1.0) - reflectance) * D(s_->tint);
  return select(passed > D(0.0), reflectance / (reflectance + passed), D(1.0));
}

}  // namespace oktett
