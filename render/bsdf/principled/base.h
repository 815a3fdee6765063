#pragma once
/// \file What the lobes of the principled material share, and what a lobe is.
///
/// A lobe is one way in which light is scattered: a class template over lanes of doubles D in a file of this
/// folder, named in the lists of render/bsdf/principled_lobes.h. It has
///
/// - `Surface`: what it needs of one side of a surface, made of its parameters and PrincipledBase, and
///   `kChances`: its number of entries among the probabilities of lobes, `first` being the first of them;
/// - `is_there(s, b)`: the surface has it; `is_delta(s, b)`: it sends light in finitely many directions;
/// - `set(s, v, arriving, chance)`: its weights for a viewer, and weights to choose it with;
/// - `sample(s, v, first, chance, out)`: directions where it was chosen, or the width of its facets.
///
/// and those that apply of
///
/// - `add_above`, `add_below(s, v, light, chance, sum)`: its value and density for light from the viewer's
///   side and from the other, if it is not delta;
/// - `reflect(s, v, facets, chance, pdf)`: its part in the light that the facets of the base reflect;
/// - `leave(s, v, first, out)`: directions that leave facets other than mirrored;
/// - `transmits(s)`: light may pass to the other side.

#include "render/bsdf/facet_widths.h"
#include "render/bsdf/thin_film.h"

namespace oktett {

/// Interfaces with less roughness are smooth: alpha = roughness^2 < 0.001.
inline constexpr double kLeastRoughness = 0.0316;
/// Interfaces whose index of refraction is closer to 1 do not bend light.
inline constexpr double kLeastIorDifference = 1e-3;

/// Whether glass of these parameters passes light without scattering it: smooth glass, and glass that does
/// not bend light.
bool is_smooth_glass(const PrincipledParameters& parameters);
/// The width of facets; 0: smooth.
double facet_width(double roughness);
/// Of the base. Stretched ones are wider along x: 1 for an anisotropy of 1 (KHR_materials_anisotropy).
FacetWidths base_facets(const PrincipledParameters& parameters);

/// The film of `iridescence` on what has these indices of refraction for each channel.
ThinFilm film_on(const PrincipledParameters& parameters, const Vec3d& eta, const Vec3d& k = {});

/// What several lobes need of one side of a surface.
struct PrincipledBase {
  PrincipledBase() = default;
  PrincipledBase(const PrincipledParameters& parameters, bool front);

  Vec3d base_color;
  double tint = 0;      ///< greatest component of base_color
  bool outside = true;  ///< the viewer is not inside glass, where neither coat nor sheen is seen
  bool front = true;    ///< the viewer is where the geometric normal points to
  bool thin = false;
  FacetWidths facets;      ///< 0: smooth
  double alpha = 0;        ///< their width, of stretched ones the root of the mean square
  MirrorAlbedo mirror;     ///< of facets of that width
  double mirror_loss = 0;  ///< its mean loss

  double metal = 0, opaque = 0, glass = 0;  ///< weights, which add to 1

  double ior = 1;                             ///< inside relative to outside
  double opaque_eta = 1, opaque_head_on = 0;  ///< of the opaque dielectric: index; reflectance head-on
  double opaque_loss = 0;                     ///< 1 - its albedo for diffuse light
  double film = 0;                            ///< weight of a thin film, as seen from outside

  /// The part of light from `w` that the opaque dielectric reflects; of a coloured one, in its brightest
  /// channel.
  template <class D>
  OKTETT_INLINE D opaque_albedo(const Vec3<D>& w) const {
    if (alpha > 0 && (facets.stretched() || film > 0)) return summed_opaque_albedo(w);
    if (film > 0) return brightest_fresnel(w.z);
    const D plain = dielectric_(w.z);
    if (!has_specular_color_) return plain;
    const D mirrored = alpha > 0 ? mirror(w.z) : D(1.0);
    return within(D(most_.slope) * plain + D(most_.rise) * mirrored, D(0.0), D(1.0));
  }
  /// The part of light from `w` that facets send on which reflect all of it.
  template <class D>
  OKTETT_INLINE D mirror_albedo(const Vec3<D>& w) const {
    if (!facets.stretched()) return mirror(w.z);
    const D r = stretched_albedo(w, facets, [](const D&) { return D(1.0); });
    return D(1.0) - lowered_loss(D(1.0) - r, kStretchedError);
  }
  /// Its reflectance, times `weight`.
  template <class D>
  OKTETT_INLINE Vec3<D> opaque_fresnel(const D& cosine, const D& weight) const {
    const D plain = weight * fresnel_lanes(cosine, D(opaque_eta));
    if (!has_specular_color_ && film == 0) return {plain, plain, plain};
    const auto part = [&](const SpecularLine& l) {
      return max(D(0.0), D(l.slope) * plain + D(l.rise) * weight);
    };
    const Vec3<D> bare{part(specular_[0]), part(specular_[1]), part(specular_[2])};
    if (film == 0) return bare;
    return bare * D(1 - film) + opaque_film_.reflectance(cosine) * (weight * D(film * specular_weight_));
  }

 private:
  /// What `specular_color` and `specular_weight` make of Fresnel's reflectance F: slope F + rise. So any
  /// reflectance head-on grows to the same at grazing angles, on a curve of the shape of Fresnel's.
  struct SpecularLine {
    double slope = 1, rise = 0;
  };
  void set_specular(const PrincipledParameters& parameters);
  void set_film(const PrincipledParameters& parameters);

  template <class D>
  D brightest_fresnel(const D& cosine) const {
    const Vec3<D> r = opaque_fresnel(cosine, D(1.0));
    return max(max(r.x, r.y), r.z);
  }
  /// Below stretched facets, or below a film on facets, by a sum over facets.
  template <class D>
  D summed_opaque_albedo(const Vec3<D>& w) const {
    const D r = film == 0 ? stretched_albedo(w, facets, [&](const D& c) { return brightest_fresnel(c); })
                          : stretched_albedo(w, facets, [&](const D& c) { return brightest_with_film(c); });
    return min(D(1.0), r + D(kStretchedDielectricError) * r / (r + D(0.02)));
  }
  /// brightest_fresnel() from its values at even distances.
  template <class D>
  OKTETT_INLINE D brightest_with_film(const D& cosine) const {
    const D place = cosine * D(kFilmNodes - 1), node = within(whole_part(place), D(0.0), D(kFilmNodes - 2));
    const D before = gather(brightest_.data(), node), after = gather(brightest_.data() + 1, node);
    return before + (after - before) * (place - node);
  }
  static constexpr int kFilmNodes = 33;

  ReflectedAlbedo dielectric_;
  bool has_specular_color_ = false;
  double specular_weight_ = 1;
  SpecularLine specular_[3], most_;  ///< of the channels, of the brightest one
  ThinFilm opaque_film_;
  std::vector<float> brightest_;  ///< empty unless there is a film on facets
};

/// What GGX facets are for a viewer; nothing for smooth interfaces.
template <class D>
struct SeenFacets {
  SeenFacets() = default;
  OKTETT_INLINE SeenFacets(const Vec3<D>& wo, const FacetWidths& widths) {
    if (widths.x == 0) return;
    lambda = ggx_lambda(wo, widths), reflected = ggx_reflected_scale(wo, widths);
  }
  D lambda{0.0}, reflected{0.0};  ///< ggx_lambda, ggx_reflected_scale
};

/// The viewer of a surface.
template <class D>
struct LobeView {
  const PrincipledBase* base;
  Vec3<D> wo;
  SeenFacets<D> facets;  ///< of the base
};

/// The light that reaches a lobe, relative to what reaches the surface. Lobes lower it for those below.
template <class D>
struct ArrivingLight {
  D all{1.0};           ///< below sheen and coat
  D under_opaque{0.0};  ///< below the interface of the opaque dielectric
};

/// A direction of light.
template <class D>
struct LobeLight {
  Vec3<D> wi;
  Vec3<D> half;  ///< halfway between it and the viewer
  D cosine;      ///< of the viewer with `half`
};

/// The sum of lobes: f |cos(wi)|, and density per solid angle.
template <class D>
struct LobeSum {
  Vec3<D> value{D(0.0), D(0.0), D(0.0)};
  D pdf{0.0};
};

/// The facets of the base that mirror one direction to the other. Metal, the opaque dielectric and glass
/// share them, so `reflectance` is the sum of theirs.
template <class D>
struct MirroringFacets {
  OKTETT_INLINE MirroringFacets(const LobeView<D>& v, const LobeLight<D>& light) : cosine(light.cosine) {
    const FacetWidths& widths = v.base->facets;
    const D normals = ggx_density(light.half, widths);
    density = normals * v.facets.reflected;
    per_area = normals / (D(4.0) * v.wo.z);
    shown = per_area / (D(1.0) + v.facets.lambda + ggx_lambda(light.wi, widths));
  }
  D cosine;    ///< of both directions with the normal of the facets
  D density;   ///< with which `wi` is sampled, if only facets are that reflect above the surface
  D per_area;  ///< f cos(wi) without masking and shadowing
  D shown;     ///< the same with them
  Vec3<D> reflectance{D(0.0), D(0.0), D(0.0)};
};

/// Directions being sampled. Lobes of facets that are chosen share the choice of a facet.
template <class D>
struct LobeSampling {
  using M = typename D::M;
  OKTETT_INLINE LobeSampling(const Vec3<D>& wo, const D& lobe, const D& place_within, const D& u, const D& v)
      : chosen(lobe),
        place(place_within),
        x(u),
        y(v),
        direction(wo),
        weight(wo),
        scattered(chosen < D(-1.0)),
        deflected(scattered),
        facets(scattered),
        all_facets(scattered),
        mirrored(scattered),
        alpha_x(0.0),
        alpha_y(0.0) {}

  OKTETT_INLINE M chose(int lobe) const { return chosen == D(lobe); }
  /// By a lobe that is not delta.
  OKTETT_INLINE void scatter(const M& lanes, const Vec3<D>& d) {
    direction = select_lanes(lanes, d, direction);
    scattered = scattered | lanes;
  }
  /// By a delta lobe, which is taken with the probability `chance`.
  OKTETT_INLINE void deflect(const M& lanes, const Vec3<D>& d, const Vec3<D>& coefficient, const D& chance) {
    direction = select_lanes(lanes, d, direction);
    weight = select_lanes(lanes, scale_lanes(coefficient, D(1.0) / chance), weight);
    const D most = max(max(coefficient.x, coefficient.y), coefficient.z);
    deflected = deflected | (lanes & (most > D(0.0)) & (chance > D(0.0)));
  }
  /// By facets, of which only those are of use that reflect above the surface.
  OKTETT_INLINE void choose_facets(const M& lanes, const FacetWidths& widths) {
    facets = facets | lanes;
    alpha_x = select(lanes, D(widths.x), alpha_x), alpha_y = select(lanes, D(widths.y), alpha_y);
  }

  D chosen, place;  ///< a lobe, and the place within its range of probability
  D x, y;           ///< a point of the unit square
  Vec3<D> direction, weight;
  M scattered, deflected;

  M facets, all_facets;  ///< lanes with facets; where those that reflect below the surface are of use, too
  M mirrored;            ///< lanes with facets that reflect
  D alpha_x, alpha_y;
  Vec3<D> normal, reflected;  ///< of a facet; the viewer's direction, mirrored by it
  D cosine;                   ///< of the viewer with the normal
};

template <class D>
OKTETT_INLINE Vec3<D> grey(const D& x) {
  return {x, x, x};
}

/// The direction that a smooth surface mirrors to the viewer.
template <class D>
OKTETT_INLINE Vec3<D> mirrored_by_surface(const Vec3<D>& wo) {
  return {-wo.x, -wo.y, wo.z};
}

/// A direction with the other side.
template <class D>
OKTETT_INLINE Vec3<D> flipped(const Vec3<D>& w) {
  return {w.x, w.y, -w.z};
}

/// Value and density of a lobe without colour.
template <class D>
struct GreyValue {
  D value, pdf;
};

/// A reflecting lobe of facets of its own: f cos = weight D G / (4 wo.z), G = 1 / (1 + Lambda(wo) +
/// Lambda(wi)). `chance` is that with which the lobe is chosen.
template <class D>
OKTETT_INLINE GreyValue<D> facet_lobe(const SeenFacets<D>& facets, double alpha, const LobeView<D>& v,
                                      const LobeLight<D>& light, const D& weight, const D& chance) {
  const D normals = ggx_density(light.half, D(alpha)), lambda = ggx_lambda(light.wi, D(alpha));
  return {weight * normals / (D(4.0) * v.wo.z * (D(1.0) + facets.lambda + lambda)),
          chance * normals * facets.reflected};
}

}  // namespace oktett
