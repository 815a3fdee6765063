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
    if (p.coat_normal.x == 0 && p.coat_normal.y == 0) return;
    tilted = true;
    normal = normalize(Vec3d(p.coat_normal));
    make_basis(normal, tangent, bitangent);
  }
  /// Into the frame about its own normal, and back.
  template <class D>
  OKTETT_INLINE Vec3<D> to_own(const Vec3<D>& w) const {
    return {dot_lanes(w, broadcast<D>(tangent)), dot_lanes(w, broadcast<D>(bitangent)),
            dot_lanes(w, broadcast<D>(normal))};
  }
  template <class D>
  OKTETT_INLINE Vec3<D> from_own(const Vec3<D>& w) const {
    return broadcast<D>(tangent) * w.x + broadcast<D>(bitangent) * w.y + broadcast<D>(normal) * w.z;
  }

  double weight = 0, alpha = 0, eta = 1;
  ReflectedAlbedo albedo;
  bool tilted = false;  ///< its normal is not that of the surface
  Vec3d normal, tangent, bitangent;
};

/// A tilted one reflects what leaves above the surface and above its own horizon. Rays from mirrors are
/// folded back above the surface instead.
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
    wo_ = s.tilted ? above_horizon(s.to_own(v.wo)) : v.wo;
    facets_ = SeenFacets<D>(wo_, s.alpha);
    *chance = weight_ * s.albedo(wo_.z);
    arriving.all = arriving.all - *chance;
  }

  OKTETT_INLINE void add_above(const Surface& s, const LobeView<D>& v, const LobeLight<D>& light,
                               const D* chance, LobeSum<D>& sum) const {
    const D weight = weight_ * fresnel_lanes(light.cosine, D(s.eta));
    if (s.tilted) return add_tilted(s, v, light, weight, *chance, sum);
    const GreyValue<D> lobe = facet_lobe(facets_, s.alpha, v, light, weight, *chance);
    sum.value = sum.value + grey(lobe.value);
    sum.pdf = sum.pdf + lobe.pdf;
  }

  OKTETT_INLINE void sample(const Surface& s, const LobeView<D>& v, int first, const D* chance,
                            LobeSampling<D>& out) const {
    const M here = out.chose(first);
    if (s.tilted) {
      if (any(here)) sample_tilted(s, here, *chance, out);
    } else if (s.alpha > 0) {
      out.choose_facets(here, s.alpha);
    } else if (any(here)) {
      out.deflect(here, mirrored_by_surface(v.wo), grey(weight_ * fresnel_lanes(v.wo.z, D(s.eta))), *chance);
    }
  }

 private:
  void add_tilted(const Surface& s, const LobeView<D>& v, const LobeLight<D>& light, const D& weight,
                  const D& chance, LobeSum<D>& sum) const {
    LobeView<D> own_view = v;
    own_view.wo = wo_;
    const LobeLight<D> own_light{s.to_own(light.wi), s.to_own(light.half), light.cosine};
    const GreyValue<D> lobe = facet_lobe(facets_, s.alpha, own_view, own_light, weight, chance);
    const D dark(0.0);
    const M seen = own_light.wi.z > dark;
    sum.value = sum.value + grey(select(seen, lobe.value, dark));
    sum.pdf = sum.pdf + select(seen, lobe.pdf, dark);
  }

  void sample_tilted(const Surface& s, const M& here, const D& chance, LobeSampling<D>& out) const {
    const D zero(0.0), two(2.0);
    if (s.alpha == 0) {
      Vec3<D> wi = s.from_own(mirrored_by_surface(wo_));
      wi.z = select(wi.z < zero, -wi.z, wi.z);
      return out.deflect(here, wi, grey(weight_ * fresnel_lanes(wo_.z, D(s.eta))), chance);
    }
    const D alpha(s.alpha);
    const Vec3<D> m = ggx_normal(wo_, alpha, reflecting_bound(wo_, alpha), out.x, out.y);
    const Vec3<D> own = m * (two * dot_lanes(wo_, m)) - wo_, wi = s.from_own(own);
    out.scatter(here & (own.z > zero) & (wi.z > zero), wi);
  }

  D weight_{0.0};
  Vec3<D> wo_;  ///< the viewer about the normal of the coat
  SeenFacets<D> facets_;
};

}  // namespace oktett
