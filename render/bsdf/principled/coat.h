#pragma once
/// \file The coat of the principled material: a clear dielectric layer, of which only the interface shows.

#include "render/bsdf/principled/base.h"

namespace oktett {

struct CoatSurface {
  CoatSurface() = default;
  OKTETT_INLINE CoatSurface(const PrincipledParameters& p, const PrincipledBase& base) {
    if (base.outside) weight = limited(p.coat, 0, 1);
    if (!(weight > 0)) return;
    alpha = facet_width(p.coat_roughness);
    eta = limited(p.coat_ior, 1, kMostIor);
    albedo = ReflectedAlbedo(eta, alpha);
  }
  double weight = 0, alpha = 0, eta = 1;
  ReflectedAlbedo albedo;
};

template <class D>
class CoatLobe {
 public:
  using M = typename D::M;
  using Surface = CoatSurface;
  static constexpr int kChances = 1;

  static bool is_there(const Surface& s, const PrincipledBase&) { return s.weight > 0; }
  static bool is_delta(const Surface& s, const PrincipledBase&) { return s.alpha == 0; }

  OKTETT_INLINE void set(const Surface& s, const LobeView<D>& v, ArrivingLight<D>& arriving, D* chance) {
    weight_ = arriving.all * D(s.weight);
    facets_ = SeenFacets<D>(v.wo, s.alpha);
    *chance = weight_ * s.albedo(v.wo.z);
    arriving.all = arriving.all - *chance;
  }

  OKTETT_INLINE void add_above(const Surface& s, const LobeView<D>& v, const LobeLight<D>& light,
                               const D* chance, LobeSum<D>& sum) const {
    const D weight = weight_ * fresnel_lanes(light.cosine, D(s.eta));
    const GreyValue<D> lobe = facet_lobe(facets_, s.alpha, v, light, weight, *chance);
    sum.value = sum.value + grey(lobe.value);
    sum.pdf = sum.pdf + lobe.pdf;
  }

  OKTETT_INLINE void sample(const Surface& s, const LobeView<D>& v, int first, const D* chance,
                            LobeSampling<D>& out) const {
    const M here = out.chose(first);
    if (s.alpha > 0)
      out.choose_facets(here, s.alpha);
    else if (any(here))
      out.deflect(here, mirrored_by_surface(v.wo), grey(weight_ * fresnel_lanes(v.wo.z, D(s.eta))), *chance);
  }

 private:
  D weight_{0.0};
  SeenFacets<D> facets_;
};

}  // namespace oktett
