#pragma once
/// \file The principled material (in the vocabulary of Burley 2012 and OpenPBR): sheen over a coat over
/// metal, an opaque dielectric or glass.
///
/// Rough interfaces are GGX facets (render/bsdf/ggx.h). What single scattering loses is given back, so no
/// roughness darkens: by metal in the lobe of wider facets (MirrorAgain), by glass in lobes that are diffuse
/// in shape (Kulla 2017). A layer takes its albedo from what lies below. Reciprocal: the base (metal,
/// dielectric over diffuse, glass up to the factor eta^2 that radiance leaves out). Not reciprocal: what lies
/// below a coat or sheen, as that is weakened by the albedo for the viewer's direction alone, and sheen
/// itself.

#include "render/bsdf/ggx.h"
#include "render/bsdf/grazing.h"
#include "render/bsdf/principled_surface.h"
#include "render/bsdf/sheen.h"

namespace oktett {

/// In lanes of doubles D, for viewers of the same surface.
template <class D>
class PrincipledLobes {
 public:
  using F = FloatsOf<D>;
  using M = typename D::M;
  using Surface = PrincipledSurface;

  PrincipledLobes(const PrincipledSurface& surface, const Vec3<F>& wo)
      : s_(&surface), wo_(direction_above<D>(wo)), base_(facets(s_->alpha)) {
    set_layers();
    if (s_->metal > 0) set_metal();
    if (s_->opaque > 0) set_opaque();
    if (s_->glass > 0) set_glass();
    choice_.normalize();
  }

  /// Value and density of the lobes that are not delta. Not inlined: GCC 12 would leave out the rounding of
  /// directions to float and back.
  OKTETT_NOINLINE BsdfValues<D> evaluate(const Vec3<F>& wi) const {
    const F dark(0.0f);
    const auto up = wi.z > dark, down = wi.z < dark;
    const Vec3<D> w = unit_lanes(to_double(wi));
    BsdfValues<D> sum{{dark, dark, dark}, dark};
    const auto put = [&](const typename F::M& lanes, const Value& v) {
      sum.value = select_lanes(lanes, to_float(v.value), sum.value);
      sum.pdf = select(lanes, to_float(v.pdf), sum.pdf);
    };
    if (any(up)) put(up, above(w));
    if (s_->glass > 0 && !s_->glass_smooth && any(down)) put(down, below(w));
    return sum;
  }

  /// As Bsdf::sample.
  BsdfSamples<D> sample(const D& lobe, const D& x, const D& y) const {
    D place = lobe;
    const D chosen = choice_.pick(place);
    BsdfSamples<D> sample;
    sample.pdf = F(0.0f);
    sample.weight = {F(0.0f), F(0.0f), F(0.0f)};
    M scattered = chosen < D(-1.0), found = scattered;
    Vec3<D> direction = wo_, weight = wo_;
    const auto scatter = [&](const M& lanes, const Vec3<D>& d) {
      direction = select_lanes(lanes, d, direction), scattered = scattered | lanes;
    };
    const auto deflect = [&](const M& lanes, const Vec3<D>& d, const Vec3<D>& coefficient, const D& chance) {
      direction = select_lanes(lanes, d, direction);
      weight = select_lanes(lanes, scale_lanes(coefficient, D(1.0) / chance), weight);
      const D most = max(max(coefficient.x, coefficient.y), coefficient.z);
      found = found | (lanes & (most > D(0.0)) & (chance > D(0.0)));
    };
    if (const M m = chosen == D(kDiffuse); any(m)) scatter(m, cosine_above(x, y));
    const M over = chosen == D(kAgainAbove), under = chosen == D(kAgainBelow);
    if (any(over | under)) {
      const Vec3<D> w = grazing_above(s_->alpha, x, y);
      scatter(over, w), scatter(under, flipped(w));
    }
    if (const M m = chosen == D(kSheen); any(m)) scatter(m, sheen_direction(x, y));
    sample_facets(chosen, place, x, y, scatter);
    sample_smooth(chosen, place, deflect);

    sample.direction = to_float(direction);
    sample.transmitted = sample.direction.z < F(0.0f);
    const auto delta = mask_cast<float>(found), rough = mask_cast<float>(scattered);
    if (any(rough)) {
      const BsdfValues<D> at = evaluate(sample.direction);
      sample.weight = {at.value.x / at.pdf, at.value.y / at.pdf, at.value.z / at.pdf};
      sample.pdf = select(rough, at.pdf, F(0.0f));
    }
    sample.weight = select_lanes(delta, to_float(weight), sample.weight);
    sample.found = delta | (rough & (sample.pdf > F(0.0f)));
    return sample;
  }

  /// The lanes in which `evaluate` is black everywhere.
  typename F::M only_delta() const {
    const D zero(0.0);
    M none = (choice_[kSheen] == zero) & (choice_[kDiffuse] == zero) & (choice_[kAgainAbove] == zero) &
             (choice_[kAgainBelow] == zero) & (choice_[kMetalAgain] == zero);
    if (s_->coat_alpha > 0) none = none & (choice_[kCoat] == zero);
    if (s_->alpha > 0) none = none & (choice_[kMirror] == zero);
    if (!s_->glass_smooth) none = none & (choice_[kGlass] == zero);
    return mask_cast<float>(none);
  }

  /// After the surface has been copied to another place.
  void rebind(const PrincipledSurface& surface) { s_ = &surface; }

 private:
  /// kMirror: metal and opaque dielectric. kGlass: reflected or transmitted, as Fresnel's equations say.
  /// kMetalAgain: what single scattering by metal loses.
  /// kAgainAbove, kAgainBelow: what single scattering by glass loses, on the viewer's side and on the other.
  enum Lobe { kSheen, kCoat, kMirror, kGlass, kDiffuse, kMetalAgain, kAgainAbove, kAgainBelow, kLobes };

  /// Of the viewer's direction; nothing for smooth interfaces.
  struct Facets {
    D lambda{0.0}, reflected{0.0};  ///< ggx_lambda, ggx_reflected_scale
  };
  struct Value {
    Vec3<D> value{D(0.0), D(0.0), D(0.0)};
    D pdf{0.0};
  };
  /// Of a lobe without colour.
  struct GreyValue {
    D value, pdf;
  };

  static Vec3<D> flipped(const Vec3<D>& w) { return {w.x, w.y, -w.z}; }
  static Vec3<D> grey(const D& x) { return {x, x, x}; }

  Facets facets(double alpha) const {
    if (alpha == 0) return {};
    return {ggx_lambda(wo_, D(alpha)), ggx_reflected_scale(wo_, D(alpha))};
  }

  // Defined in render/bsdf/principled_setup.h.
  void set_layers();
  void set_metal();
  void set_opaque();
  void set_glass();

  Vec3<D> metal_fresnel(const D& cosine) const;
  D glass_fresnel(const D& cosine) const;
  D chance_of_reflection(const D& reflectance) const;

  // Defined in render/bsdf/principled_values.h.
  GreyValue facet_lobe(const Facets& f, double alpha, const Vec3<D>& h, const Vec3<D>& wi, const D& weight,
                       const D& chance) const;
  Value above(const Vec3<D>& wi) const;
  Value below(const Vec3<D>& wi) const;
  Value transmitted(const Vec3<D>& wi) const;
  D sheen_density(const Vec3<D>& wi) const;

  // Defined in render/bsdf/principled_samples.h.
  template <class Scatter>
  void sample_facets(const D& chosen, const D& place, const D& x, const D& y, Scatter&& scatter) const;
  template <class Deflect>
  void sample_smooth(const D& chosen, const D& place, Deflect&& deflect) const;
  Vec3<D> sheen_direction(const D& x, const D& y) const;

  const PrincipledSurface* s_;
  Vec3<D> wo_;
  Facets base_, coat_facets_, again_facets_;
  D sheen_{0.0}, coat_{0.0}, metal_{0.0}, opaque_{0.0}, glass_{0.0};  ///< weights, without what lies above
  SheenLobe fibres_[D::kWidth];
  D metal_again_{0.0};  ///< weight of metal times the scale of MirrorAgain
  // Lobes of diffuse shape: coefficient * loss(wi) * |cos(wi)|.
  D diffuse_{0.0}, glass_again_above_{0.0}, glass_again_below_{0.0};
  LobeChances<D, kLobes> choice_;
};

}  // namespace oktett

#include "render/bsdf/principled_samples.h"
#include "render/bsdf/principled_setup.h"
#include "render/bsdf/principled_values.h"
