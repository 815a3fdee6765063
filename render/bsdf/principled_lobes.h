#pragma once
/// \file The principled material (in the vocabulary of Burley 2012 and OpenPBR): sheen over a coat over
/// metal, an opaque dielectric or glass. Each lobe stands in a file of render/bsdf/principled; here they are
/// listed and put together.
///
/// Rough interfaces are GGX facets (render/bsdf/ggx_albedo.h). What single scattering loses is given back, so
/// no roughness darkens: by metal in the lobe of wider facets (MirrorMultipleScattering), by glass in lobes
/// that are diffuse in shape (Kulla 2017). A layer takes its albedo from what lies below. Reciprocal: the
/// base (metal, dielectric over diffuse, glass up to the factor eta^2 that radiance leaves out). Not
/// reciprocal: what lies below a coat or sheen, as that is weakened by the albedo for the viewer's direction
/// alone, and sheen itself.

#include <type_traits>

#include "render/bsdf/principled/coat.h"
#include "render/bsdf/principled/diffuse.h"
#include "render/bsdf/principled/glass.h"
#include "render/bsdf/principled/mirror.h"
#include "render/bsdf/principled/sheen.h"

namespace oktett {

template <template <class> class... L>
struct LobeList {};

/// The lobes in the order in which their weights are found and one of them is chosen: layers from the top.
using PrincipledList =
    LobeList<SheenLobe, CoatLobe, MirrorLobe, GlassLobe, DiffuseLobe, MetalMultipleLobe, GlassMultipleLobe>;
/// The same lobes in the order in which their values are added.
using PrincipledSum =
    LobeList<MirrorLobe, GlassLobe, CoatLobe, MetalMultipleLobe, DiffuseLobe, GlassMultipleLobe, SheenLobe>;

/// What the lobes of a list need of one side of a surface.
template <class List>
struct SurfaceOf;
template <template <class> class... L>
struct SurfaceOf<LobeList<L...>> : PrincipledBase, L<Simd<double, 1, ScalarIsa>>::Surface... {
  SurfaceOf() = default;
  SurfaceOf(const PrincipledParameters& p, const PrincipledBase& b)
      : PrincipledBase(b), L<Simd<double, 1, ScalarIsa>>::Surface(p, b)... {}
};

/// The lobes of a list for a viewer.
template <class D, class List>
struct LobesOf;
template <class D, template <class> class... L>
struct LobesOf<D, LobeList<L...>> : L<D>... {
  static constexpr int kChances = (0 + ... + L<D>::kChances);

  /// The first entry of a lobe among the probabilities.
  template <class Lobe>
  static constexpr int first_of() {
    int first = 0;
    bool found = false;
    ((found = found || std::is_same_v<Lobe, L<D>>, first += found ? 0 : L<D>::kChances), ...);
    return first;
  }
};

/// What one side of a surface of the principled material needs, whatever the directions.
struct PrincipledSurface : SurfaceOf<PrincipledList> {
  PrincipledSurface() = default;
  /// `is_front`: the viewer is outside, where the geometric normal points to.
  PrincipledSurface(const PrincipledParameters& p, bool is_front);

  /// Whether its lobes are black but in finitely many directions.
  bool only_delta() const;
  /// Whether light may pass to the other side.
  bool transmits() const;

  Vec2f stretch{1, 0};  ///< by which its frame is turned, see PrincipledParameters
};

/// In lanes of doubles D, for viewers of the same surface.
template <class D>
class PrincipledLobes {
 public:
  using F = FloatsOf<D>;
  using M = typename D::M;
  using Surface = PrincipledSurface;

  PrincipledLobes(const PrincipledSurface& surface, const Vec3<F>& wo)
      : s_(&surface), view_{&surface, direction_above<D>(wo), {}} {
    view_.facets = SeenFacets<D>(view_.wo, base().facets);
    ArrivingLight<D> arriving;
    each(PrincipledList{}, lobes_,
         [&](auto& lobe, const auto& s, int first) { lobe.set(s, view_, arriving, &choice_[first]); });
    choice_.normalize();
  }

  /// Value and density of the lobes that are not delta. Not inlined: GCC 12 would leave out the rounding of
  /// directions to float and back.
  OKTETT_NOINLINE BsdfValues<D> evaluate(const Vec3<F>& wi) const {
    const F dark(0.0f);
    const auto up = wi.z > dark, down = wi.z < dark;
    const Vec3<D> w = unit_lanes(to_double(wi));
    BsdfValues<D> result{{dark, dark, dark}, dark};
    const auto put = [&](const typename F::M& lanes, const LobeSum<D>& sum) {
      result.value = select_lanes(lanes, to_float(sum.value), result.value);
      result.pdf = select(lanes, to_float(sum.pdf), result.pdf);
    };
    if (any(up)) put(up, above(w));
    if (any(down)) put(down, below(w));
    return result;
  }

  /// As Bsdf::sample.
  BsdfSamples<D> sample(const D& lobe, const D& x, const D& y) const {
    D place = lobe;
    const D chosen = choice_.pick(place);
    LobeSampling<D> drawn(view_.wo, chosen, place, x, y);
    each(PrincipledList{}, lobes_, [&](const auto& some, const auto& s, int first) {
      some.sample(s, view_, first, &choice_[first], drawn);
    });
    if (any(drawn.facets)) sample_facets(drawn);

    BsdfSamples<D> sample;
    sample.pdf = F(0.0f);
    sample.weight = {F(0.0f), F(0.0f), F(0.0f)};
    sample.direction = to_float(drawn.direction);
    sample.transmitted = sample.direction.z < F(0.0f);
    const auto delta = mask_cast<float>(drawn.deflected), rough = mask_cast<float>(drawn.scattered);
    if (any(rough)) {
      const BsdfValues<D> at = evaluate(sample.direction);
      sample.weight = {at.value.x / at.pdf, at.value.y / at.pdf, at.value.z / at.pdf};
      sample.pdf = select(rough, at.pdf, F(0.0f));
    }
    sample.weight = select_lanes(delta, to_float(drawn.weight), sample.weight);
    sample.found = delta | (rough & (sample.pdf > F(0.0f)));
    return sample;
  }

  /// The lanes in which `sample` chooses a lobe that is diffuse in shape.
  M chooses_diffuse(D lobe) const {
    const D chosen = choice_.pick(lobe);
    const auto is = [&](int first, int count) { return (chosen >= D(first)) & (chosen < D(first + count)); };
    return is(Lobes::template first_of<SheenLobe<D>>(), SheenLobe<D>::kChances) |
           is(Lobes::template first_of<DiffuseLobe<D>>(), DiffuseLobe<D>::kChances) |
           is(Lobes::template first_of<GlassMultipleLobe<D>>(), GlassMultipleLobe<D>::kChances);
  }

  /// The lanes in which `evaluate` is black everywhere.
  typename F::M only_delta() const {
    M none = view_.wo.z == view_.wo.z;
    each(PrincipledList{}, lobes_, [&](const auto& lobe, const auto& s, int first) {
      if (lobe.is_delta(s, base())) return;
      for (int i = 0; i < lobe.kChances; ++i) none = none & (choice_[first + i] == D(0.0));
    });
    return mask_cast<float>(none);
  }

  bool transmits() const { return s_->transmits(); }

  /// The part of the viewer's light that its glass, which must be smooth, lets pass, colour left out.
  Vec3<D> passing_glass() const {
    const GlassSurface& glass = *s_;
    return GlassLobe<D>::is_there(glass, base()) ? of<GlassLobe<D>>(lobes_).passing(glass, view_)
                                                 : grey(D(0.0));
  }

  /// After the surface has been copied to another place.
  void rebind(const PrincipledSurface& surface) {
    s_ = &surface;
    view_.base = &surface;
  }

 private:
  using Lobes = LobesOf<D, PrincipledList>;

  const PrincipledBase& base() const { return *s_; }

  /// Calls act(lobe, its surface, its first entry among the probabilities) for lobes that the surface has.
  template <template <class> class... L, class SomeLobes, class Act>
  OKTETT_INLINE void each(LobeList<L...>, SomeLobes& lobes, Act&& act) const {
    const auto call = [&](auto& lobe, const auto& s, int first) {
      if (lobe.is_there(s, base())) act(lobe, s, first);
    };
    (call(of<L<D>>(lobes), static_cast<const typename L<D>::Surface&>(*s_), Lobes::template first_of<L<D>>()),
     ...);
  }
  template <class Lobe>
  static OKTETT_INLINE Lobe& of(Lobes& lobes) {
    return lobes;
  }
  template <class Lobe>
  static OKTETT_INLINE const Lobe& of(const Lobes& lobes) {
    return lobes;
  }

  OKTETT_INLINE LobeSum<D> above(const Vec3<D>& wi) const {
    const Vec3<D> half = unit_lanes(view_.wo + wi);
    const LobeLight<D> light{wi, half, min(D(1.0), dot_lanes(view_.wo, half))};
    LobeSum<D> sum;
    if (base().alpha > 0) {
      MirroringFacets<D> facets(view_, light);
      each(PrincipledSum{}, lobes_, [&](const auto& lobe, const auto& s, int first) {
        if constexpr (requires { lobe.reflect(s, view_, facets, &choice_[first], sum.pdf); })
          lobe.reflect(s, view_, facets, &choice_[first], sum.pdf);
      });
      sum.value = facets.reflectance * facets.shown;
    }
    each(PrincipledSum{}, lobes_, [&](const auto& lobe, const auto& s, int first) {
      if constexpr (requires { lobe.add_above(s, view_, light, &choice_[first], sum); })
        if (!lobe.is_delta(s, base())) lobe.add_above(s, view_, light, &choice_[first], sum);
    });
    return sum;
  }

  OKTETT_INLINE LobeSum<D> below(const Vec3<D>& wi) const {
    LobeSum<D> sum;
    each(PrincipledSum{}, lobes_, [&](const auto& lobe, const auto& s, int first) {
      if constexpr (requires { lobe.add_below(s, view_, wi, &choice_[first], sum); })
        if (!lobe.is_delta(s, base())) lobe.add_below(s, view_, wi, &choice_[first], sum);
    });
    return sum;
  }

  /// Directions that leave the facets of the lobes that were chosen.
  OKTETT_INLINE void sample_facets(LobeSampling<D>& out) const {
    const D one(1.0);
    if (base().facets.stretched()) {
      const D bound = select(out.all_facets, one, reflecting_bound(view_.wo, out.alpha_x, out.alpha_y));
      out.normal = ggx_normal(view_.wo, out.alpha_x, out.alpha_y, bound, out.x, out.y);
    } else {
      const D bound = select(out.all_facets, one, reflecting_bound(view_.wo, out.alpha_x));
      out.normal = ggx_normal(view_.wo, out.alpha_x, bound, out.x, out.y);
    }
    out.cosine = dot_lanes(view_.wo, out.normal);
    out.reflected = out.normal * (D(2.0) * out.cosine) - view_.wo;
    out.mirrored = out.facets;
    each(PrincipledList{}, lobes_, [&](const auto& lobe, const auto& s, int first) {
      if constexpr (requires { lobe.leave(s, view_, first, out); }) lobe.leave(s, view_, first, out);
    });
    out.scatter(out.mirrored & (out.reflected.z > D(0.0)), out.reflected);
  }

  const PrincipledSurface* s_;
  LobeView<D> view_;
  Lobes lobes_;
  LobeChances<D, Lobes::kChances> choice_;
};

}  // namespace oktett
