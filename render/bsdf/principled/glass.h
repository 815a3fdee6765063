#pragma once
/// \file Glass of the principled material: facets that reflect or transmit, as Fresnel's equations say, or a
/// thin wall; and what single scattering by them loses (Kulla 2017), in a lobe of diffuse shape on each side.

#include "render/bsdf/principled/base.h"

namespace oktett {

struct GlassSurface {
  GlassSurface() = default;
  OKTETT_INLINE GlassSurface(const PrincipledParameters& p, const PrincipledBase& base)
      : transmits(p.transmission > 0) {
    if (!(base.glass > 0)) return;
    eta = base.front || base.thin ? base.ior : 1 / base.ior;
    smooth = is_smooth_glass(p);
    film_weight = limited(p.iridescence, 0, 1);
    if (film_weight > 0) film = film_on(p, Vec3d{1, 1, 1} * base.ior);
  }
  bool transmits = false;  ///< also where metal hides all glass
  double eta = 1;          ///< index of refraction, behind relative to before
  bool smooth = true;
  double film_weight = 0;  ///< of a film on the outside
  ThinFilm film;
};

/// What glass reflects: in the mean, and each channel.
template <class D>
struct GlassFresnel {
  D mean;
  Vec3<D> color;
};

template <class D>
class GlassLobe {
 public:
  using M = typename D::M;
  using Surface = GlassSurface;
  static constexpr int kChances = 1;

  static bool is_there(const Surface&, const PrincipledBase& b) { return b.glass > 0; }
  static bool is_delta(const Surface& s, const PrincipledBase&) { return s.smooth; }
  static bool transmits(const Surface& s) { return s.transmits; }

  OKTETT_INLINE void set(const Surface& s, const LobeView<D>& v, ArrivingLight<D>& arriving, D* chance) {
    weight_ = arriving.all * D(v.base->glass);
    const D reflectance = fresnel_of(s, *v.base, v.wo.z).mean;
    *chance = weight_ * max(D(0.02), reflectance + (D(1.0) - reflectance) * D(v.base->tint));
  }

  OKTETT_INLINE void reflect(const Surface& s, const LobeView<D>& v, MirroringFacets<D>& facets,
                             const D* chance, D& pdf) const {
    if (s.smooth) return;
    const GlassFresnel<D> f = fresnel_of(s, *v.base, facets.cosine);
    const D visible = facets.per_area / (D(1.0) + v.facets.lambda);
    facets.reflectance = facets.reflectance + f.color * weight_;
    pdf = pdf + *chance * chance_of_reflection(*v.base, f.mean) * (v.base->thin ? facets.density : visible);
  }

  /// Transmission through facets (Walter 2007), without the factor eta^2 of radiance. Through a thin wall it
  /// is reflection with the light on the other side.
  OKTETT_INLINE void add_below(const Surface& s, const LobeView<D>& v, const Vec3<D>& wi, const D* chance,
                               LobeSum<D>& sum) const {
    const bool thin = v.base->thin;
    const FacetWidths& widths = v.base->facets;
    const D one(1.0), zero(0.0), eta(s.eta);
    const Vec3<D> both = thin ? v.wo + flipped(wi) : v.wo + wi * eta;
    const D size = length_lanes(both);
    M seen = size > zero;
    const Vec3<D> h = scale_lanes(both, one / select(both.z < zero, -size, size));
    const D c = min(one, dot_lanes(v.wo, h)), d = dot_lanes(wi, h);
    const GlassFresnel<D> reflectance = fresnel_of(s, *v.base, c);
    const D normals = ggx_density(h, widths);
    D facing, density;
    if (thin) {
      facing = normals / (D(4.0) * v.wo.z);
      density = normals * v.facets.reflected;
    } else {
      seen = seen & (c > zero) & (d < zero);
      const D t = c + eta * d;
      facing = normals * c / v.wo.z * eta * eta * -d / (t * t);
      density = facing / (one + v.facets.lambda);
    }
    const D shown = facing / (one + v.facets.lambda + ggx_lambda(wi, widths));
    const D pdf = *chance * (one - chance_of_reflection(*v.base, reflectance.mean)) * density;
    sum.value = sum.value + passed(s, *v.base, reflectance, shown, seen);
    sum.pdf = sum.pdf + select(seen, pdf, zero);
  }

  OKTETT_INLINE void sample(const Surface& s, const LobeView<D>& v, int first, const D* chance,
                            LobeSampling<D>& out) const {
    const M here = out.chose(first);
    if (s.smooth) {
      if (any(here)) sample_smooth(s, v, here, *chance, out);
      return;
    }
    out.choose_facets(here, v.base->facets);
    if (!v.base->thin) out.all_facets = out.all_facets | here;
  }

  /// The part of light that smooth glass lets pass, colour left out.
  OKTETT_INLINE Vec3<D> passing(const Surface& s, const LobeView<D>& v) const {
    return left_by(fresnel_of(s, *v.base, v.wo.z));
  }

  /// Light that facets let pass.
  OKTETT_INLINE void leave(const Surface& s, const LobeView<D>& v, int first, LobeSampling<D>& out) const {
    if (s.smooth) return;
    const M here = out.chose(first);
    if (none(here)) return;
    const D zero(0.0), c = out.cosine;
    const M passes = here & ~(out.place < chance_of_reflection(*v.base, fresnel_of(s, *v.base, c).mean));
    out.mirrored = out.mirrored & ~passes;
    if (v.base->thin) {
      out.scatter(passes & (out.reflected.z > zero), flipped(out.reflected));
      return;
    }
    const D eta(s.eta), ratio(1 / s.eta);
    const D cos_behind = sqrt(max(zero, D(1.0) - (D(1.0) - c * c) / (eta * eta)));
    const Vec3<D> wi = out.normal * (c / eta - cos_behind) - v.wo * ratio;
    out.scatter(passes & (wi.z < zero), wi);
  }

 private:
  /// What is not reflected.
  OKTETT_INLINE Vec3<D> left_by(const GlassFresnel<D>& f) const {
    const D one(1.0);
    return {weight_ * (one - f.color.x), weight_ * (one - f.color.y), weight_ * (one - f.color.z)};
  }
  /// Of a thin wall: with all reflections inside it.
  static OKTETT_INLINE GlassFresnel<D> fresnel_of(const Surface& s, const PrincipledBase& b,
                                                  const D& cosine) {
    const D f = min(D(1.0), fresnel_lanes(cosine, D(s.eta)));
    if (s.film_weight > 0) return with_film(s, b, cosine, f);
    const D all = b.thin ? with_inside(f) : f;
    return {all, {all, all, all}};
  }
  static OKTETT_INLINE D with_inside(const D& f) { return D(2.0) * f / (D(1.0) + f); }
  /// A film without losses reflects as much from inside, at the angle that light has outside.
  static GlassFresnel<D> with_film(const Surface& s, const PrincipledBase& b, const D& cosine,
                                   const D& bare) {
    const D one(1.0), eta(s.eta);
    const bool outside = b.front || b.thin;
    const D out2 = one - (one - cosine * cosine) / (eta * eta);
    const Vec3<D> film = s.film.reflectance(outside ? cosine : sqrt(max(D(0.0), out2)));
    const auto part = [&](const D& r) {
      const D all = outside ? r : select(out2 > D(0.0), r, one);
      const D mixed = bare * D(1 - s.film_weight) + all * D(s.film_weight);
      return b.thin ? with_inside(mixed) : mixed;
    };
    const Vec3<D> color{part(film.x), part(film.y), part(film.z)};
    return {(color.x + color.y + color.z) * D(1 / 3.0), color};
  }
  /// Of light that facets let pass, where `seen`.
  OKTETT_INLINE Vec3<D> passed(const Surface& s, const PrincipledBase& b, const GlassFresnel<D>& f,
                               const D& shown, const M& seen) const {
    const D one(1.0), zero(0.0);
    const auto part = [&](const D& r) { return select(seen, weight_ * (one - r) * shown, zero); };
    const Vec3<D> color = broadcast<D>(b.base_color);
    if (s.film_weight == 0) return color * part(f.mean);
    return color * Vec3<D>{part(f.color.x), part(f.color.y), part(f.color.z)};
  }
  /// Of a sample of glass.
  static OKTETT_INLINE D chance_of_reflection(const PrincipledBase& b, const D& reflectance) {
    const D passed = (D(1.0) - reflectance) * D(b.tint);
    return select(passed > D(0.0), reflectance / (reflectance + passed), D(1.0));
  }

  OKTETT_INLINE void sample_smooth(const Surface& s, const LobeView<D>& v, const M& here, const D& chosen,
                                   LobeSampling<D>& out) const {
    const D one(1.0);
    const GlassFresnel<D> reflectance = fresnel_of(s, *v.base, v.wo.z);
    const D chance = chance_of_reflection(*v.base, reflectance.mean);
    const M reflects = out.place < chance;
    out.deflect(here & reflects, mirrored_by_surface(v.wo), reflectance.color * weight_, chosen * chance);
    Vec3<D> wi = -v.wo;
    if (!v.base->thin) {
      const D ratio(1 / s.eta);
      wi.x = wi.x * ratio;
      wi.y = wi.y * ratio;
      wi.z = -sqrt(max(D(0.0), one - (wi.x * wi.x + wi.y * wi.y)));
    }
    out.deflect(here & ~reflects, wi, broadcast<D>(v.base->base_color) * left_by(reflectance),
                chosen * (one - chance));
  }

  D weight_{0.0};
};

/// The light that single scattering loses is split between both sides such that the split is the same
/// backwards (Kulla 2017).
struct GlassMultipleSurface {
  GlassMultipleSurface() = default;
  OKTETT_INLINE GlassMultipleSurface(const PrincipledParameters& p, const PrincipledBase& base) {
    const GlassSurface glass(p, base);
    if (glass.smooth) return;
    eta = glass.eta;
    const double high = std::max(eta, 1 / eta), transmittance = 1 - mean_fresnel(high);
    if (base.thin) {
      loss = loss_behind = base.mirror_loss;
      passed = transmittance / (2 - transmittance);
    } else {
      albedo = GlassAlbedo(eta, base.alpha), albedo_behind = GlassAlbedo(1 / eta, base.alpha);
      loss = albedo.mean_loss(), loss_behind = albedo_behind.mean_loss();
      passed = transmittance * std::min(1.0, loss_behind / loss) / (eta > 1 ? 1 : high * high);
    }
  }
  /// The part of light from `w` that reflection and transmission by facets send on.
  template <class D>
  OKTETT_INLINE D albedo_of(const Vec3<D>& w, const FacetWidths& facets) const {
    if (!facets.stretched()) return albedo(w.z);
    return D(1.0) - lowered_loss(D(1.0) - stretched_glass_albedo(w, facets, eta), kStretchedError);
  }

  double eta = 1;  ///< as of GlassSurface
  GlassAlbedo albedo, albedo_behind;
  double loss = 0, loss_behind = 0;  ///< mean losses of these, or of mirrors for thin glass
  double passed = 0;                 ///< which part of the light that single scattering loses is transmitted
};

/// Its value is coefficient * loss(wi) * |cos(wi)|. Samples are at grazing angles, where narrow facets leave
/// the light: the cosine has a density in proportion to its power t, t = -1/2 for narrow facets, 0 for wider
/// ones, 1 for the widest. Of these, each has the least variance in its range of alpha.
template <class D>
class GlassMultipleLobe {
 public:
  using M = typename D::M;
  using Surface = GlassMultipleSurface;
  static constexpr int kChances = 2;  ///< on the viewer's side and on the other

  static bool is_there(const Surface& s, const PrincipledBase&) { return s.loss > 0 && s.loss_behind > 0; }
  static bool is_delta(const Surface&, const PrincipledBase&) { return false; }

  OKTETT_INLINE void set(const Surface& s, const LobeView<D>& v, ArrivingLight<D>& arriving, D* chance) {
    const D albedo = v.base->thin ? v.base->mirror_albedo(v.wo) : s.albedo_of(v.wo, v.base->facets);
    const D lost = arriving.all * D(v.base->glass) * (D(1.0) - albedo);
    const D above = lost * D(1 - s.passed), below = lost * D(s.passed);
    above_ = above * D(1 / (std::numbers::pi * s.loss));
    below_ = below * D(1 / (std::numbers::pi * s.loss_behind));
    chance[0] = above;
    chance[1] = below * D(v.base->tint);
  }

  OKTETT_INLINE void add_above(const Surface& s, const LobeView<D>& v, const LobeLight<D>& light,
                               const D* chance, LobeSum<D>& sum) const {
    const M some = chance[0] > D(0.0);
    if (none(some)) return;
    const D cosine = light.wi.z, loss = D(1.0) - (v.base->thin ? v.base->mirror(cosine) : s.albedo(cosine));
    sum.value = sum.value + grey(above_ * loss * cosine);
    sum.pdf = sum.pdf + select(some, chance[0] * density(v.base->alpha, cosine), D(0.0));
  }

  OKTETT_INLINE void add_below(const Surface& s, const LobeView<D>& v, const Vec3<D>& wi, const D* chance,
                               LobeSum<D>& sum) const {
    const M some = chance[1] > D(0.0);
    if (none(some)) return;
    const D cosine = -wi.z, albedo = v.base->thin ? v.base->mirror(cosine) : s.albedo_behind(cosine);
    sum.value = sum.value + broadcast<D>(v.base->base_color) *
                                (select(some, below_, D(0.0)) * ((D(1.0) - albedo) * cosine));
    sum.pdf = sum.pdf + select(some, chance[1] * density(v.base->alpha, cosine), D(0.0));
  }

  OKTETT_INLINE void sample(const Surface&, const LobeView<D>& v, int first, const D*,
                            LobeSampling<D>& out) const {
    const M over = out.chose(first), under = out.chose(first + 1);
    if (none(over | under)) return;
    const Vec3<D> w = direction(v.base->alpha, out.x, out.y);
    out.scatter(over, w);
    out.scatter(under, flipped(w));
  }

 private:
  static constexpr double kNarrowFacets = 0.0625, kWideFacets = 0.16;

  static OKTETT_INLINE Vec3<D> direction(double alpha, const D& x, const D& y) {
    if (alpha > kWideFacets) return cosine_above(x, y);
    const D cosine = alpha > kNarrowFacets ? x : x * x, size = sqrt(D(1.0) - cosine * cosine);
    D sine_turn, cosine_turn;
    sin_cos_of_turn(y, sine_turn, cosine_turn);
    return {size * cosine_turn, size * sine_turn, cosine};
  }
  /// Per solid angle.
  static OKTETT_INLINE D density(double alpha, const D& cosine) {
    if (alpha > kWideFacets) return cosine * D(1 / std::numbers::pi);
    if (alpha > kNarrowFacets) return D(1 / (2 * std::numbers::pi));
    return D(1.0) / (D(4 * std::numbers::pi) * sqrt(cosine));
  }

  D above_{0.0}, below_{0.0};
};

}  // namespace oktett
