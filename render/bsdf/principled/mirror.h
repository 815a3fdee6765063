#pragma once
/// \file The interfaces of the principled material that only reflect: metal and the opaque dielectric, which
/// share facets; and what single scattering by the facets of metal loses (Kulla 2017), as a lobe of wider
/// facets.

#include "render/bsdf/principled/base.h"

namespace oktett {

/// Fresnel's reflectance of metal from that head-on (Schlick 1994).
template <class D>
OKTETT_INLINE Vec3<D> schlick(const Vec3d& head_on, const D& cosine) {
  const D x = D(1.0) - cosine, x5 = x * x * x * x * x;
  const auto part = [&](double h) { return D(h) + D(1 - h) * x5; };
  return {part(head_on.x), part(head_on.y), part(head_on.z)};
}

struct MirrorSurface {
  MirrorSurface() = default;
  OKTETT_INLINE MirrorSurface(const PrincipledParameters& p, const PrincipledBase& base) {
    if (!(base.metal > 0)) return;
    has_conductor = p.conductor.has_value();
    if (has_conductor) {
      eta = limited(p.conductor->eta, 1e-3, 1e3);
      k = limited(p.conductor->k, 0, 1e3);
    }
    if (base.film == 0) return;
    const auto& c = base.base_color;
    const Vec3d like_color{ior_of_head_on(c.x), ior_of_head_on(c.y), ior_of_head_on(c.z)};
    film = film_on(p, has_conductor ? eta : like_color, k);
  }
  /// Of metal.
  template <class D>
  OKTETT_INLINE Vec3<D> fresnel_of(const PrincipledBase& base, const D& cosine) const {
    const Vec3<D> bare = bare_fresnel(base, cosine);
    if (base.film == 0) return bare;
    return bare * D(1 - base.film) + film.reflectance(cosine) * D(base.film);
  }
  bool has_conductor = false;
  Vec3d eta, k;
  ThinFilm film;

 private:
  template <class D>
  OKTETT_INLINE Vec3<D> bare_fresnel(const PrincipledBase& base, const D& cosine) const {
    if (!has_conductor) return schlick(base.base_color, cosine);
    return {conductor_fresnel_lanes(cosine, eta.x, k.x), conductor_fresnel_lanes(cosine, eta.y, k.y),
            conductor_fresnel_lanes(cosine, eta.z, k.z)};
  }
};

template <class D>
class MirrorLobe {
 public:
  using M = typename D::M;
  using Surface = MirrorSurface;
  static constexpr int kChances = 1;

  static bool is_there(const Surface&, const PrincipledBase& b) { return b.metal > 0 || b.opaque > 0; }
  static bool is_delta(const Surface&, const PrincipledBase& b) { return b.alpha == 0; }

  OKTETT_INLINE void set(const Surface& s, const LobeView<D>& v, ArrivingLight<D>& arriving, D* chance) {
    const PrincipledBase& b = *v.base;
    metal_ = arriving.all * D(b.metal), opaque_ = arriving.all * D(b.opaque);
    if (b.metal > 0) {
      const Vec3<D> reflected = s.fresnel_of(b, v.wo.z);
      // At least a little, since black metal is black head-on and white at grazing angles.
      *chance = *chance + metal_ * max(D(0.02), max(max(reflected.x, reflected.y), reflected.z));
    }
    if (b.opaque > 0) {
      const D reflected = b.opaque_albedo(v.wo);
      *chance = *chance + opaque_ * max(D(b.opaque_head_on), reflected);
      arriving.under_opaque = opaque_ * (D(1.0) - reflected);
    }
  }

  OKTETT_INLINE void reflect(const Surface& s, const LobeView<D>& v, MirroringFacets<D>& facets,
                             const D* chance, D& pdf) const {
    facets.reflectance = facets.reflectance + reflectance(s, *v.base, facets.cosine);
    pdf = pdf + *chance * facets.density;
  }

  OKTETT_INLINE void sample(const Surface& s, const LobeView<D>& v, int first, const D* chance,
                            LobeSampling<D>& out) const {
    const M here = out.chose(first);
    if (v.base->alpha > 0)
      out.choose_facets(here, v.base->facets);
    else if (any(here))
      out.deflect(here, mirrored_by_surface(v.wo), reflectance(s, *v.base, v.wo.z), *chance);
  }

 private:
  OKTETT_INLINE Vec3<D> reflectance(const Surface& s, const PrincipledBase& b, const D& cosine) const {
    Vec3<D> sum{D(0.0), D(0.0), D(0.0)};
    if (b.metal > 0) sum = s.fresnel_of(b, cosine) * metal_;
    if (b.opaque > 0) sum = sum + b.opaque_fresnel(cosine, opaque_);
    return sum;
  }

  D metal_{0.0}, opaque_{0.0};  ///< weights, without what lies above
};

/// The fraction of diffuse light that metal reflects: the mean of `fresnel_of(cosine)` weighted by 2 cosine.
template <class Fresnel>
Vec3d mean_reflectance(Fresnel&& fresnel_of) {
  // Gauss's rule of four points.
  static constexpr double kPoint[] = {0.0694318442029737, 0.330009478207572, 0.669990521792428,
                                      0.930568155797026};
  static constexpr double kWeight[] = {0.173927422568727, 0.326072577431273, 0.326072577431273,
                                       0.173927422568727};
  Vec3d sum;
  for (int i = 0; i < 4; ++i) sum += fresnel_of(kPoint[i]) * (2 * kPoint[i] * kWeight[i]);
  return sum;
}

struct MetalMultipleSurface {
  MetalMultipleSurface() = default;
  OKTETT_INLINE MetalMultipleSurface(const PrincipledParameters& p, const PrincipledBase& base) {
    const double loss = base.mirror_loss;
    if (!(base.metal > 0 && loss > 0)) return;
    lobe = MirrorMultipleScattering(base.alpha);
    const MirrorSurface metal(p, base);
    using Single = Simd<double, 1, ScalarIsa>;
    const Vec3d mean =
        metal.has_conductor || base.film > 0
            ? mean_reflectance([&](double c) { return only_lane(metal.fresnel_of(base, Single(c))); })
            : base.base_color + (Vec3d{1, 1, 1} - base.base_color) * (1 / 21.0);
    for (int i = 0; i < 3; ++i) color[i] = mean[i] * mean[i] * (1 - loss) / (1 - mean[i] * loss);
    most = max_component(color);
  }
  Vec3d color;      ///< what facets reflect of the light that they send to each other
  double most = 0;  ///< its greatest component; 0: there is no such light
  MirrorMultipleScattering lobe;
};

template <class D>
class MetalMultipleLobe {
 public:
  using M = typename D::M;
  using Surface = MetalMultipleSurface;
  static constexpr int kChances = 1;

  static bool is_there(const Surface& s, const PrincipledBase&) { return s.most > 0; }
  static bool is_delta(const Surface&, const PrincipledBase&) { return false; }

  OKTETT_INLINE void set(const Surface& s, const LobeView<D>& v, ArrivingLight<D>& arriving, D* chance) {
    const D metal = arriving.all * D(v.base->metal);
    facets_ = SeenFacets<D>(v.wo, s.lobe.alpha());
    weight_ = metal * s.lobe.scale(v.wo.z);
    D lost = D(1.0) - v.base->mirror_albedo(v.wo);
    if (v.base->facets.stretched()) {
      // The lobe has the albedo of what facets lose that are as wide everywhere.
      const D even = D(1.0) - v.base->mirror(v.wo.z);
      const M some = even > D(0.0);
      lost = select(some, lost, D(0.0));
      weight_ = select(some, weight_ * (lost / even), D(0.0));
    }
    *chance = metal * lost * D(s.most);
  }

  OKTETT_INLINE void add_above(const Surface& s, const LobeView<D>& v, const LobeLight<D>& light,
                               const D* chance, LobeSum<D>& sum) const {
    const D weight = weight_ * s.lobe.scale(light.wi.z);
    const GreyValue<D> lobe = facet_lobe(facets_, s.lobe.alpha(), v, light, weight, *chance);
    sum.value = sum.value + broadcast<D>(s.color) * lobe.value;
    sum.pdf = sum.pdf + lobe.pdf;
  }

  OKTETT_INLINE void sample(const Surface& s, const LobeView<D>&, int first, const D*,
                            LobeSampling<D>& out) const {
    out.choose_facets(out.chose(first), s.lobe.alpha());
  }

 private:
  SeenFacets<D> facets_;
  D weight_{0.0};  ///< of metal, times the scale of MirrorMultipleScattering
};

}  // namespace oktett
