#pragma once
/// \file The principled material (in the vocabulary of Burley 2012 and OpenPBR): sheen over a coat over
/// metal, an opaque dielectric or glass.
///
/// Rough interfaces are GGX facets (render/bsdf/ggx.h). What single scattering loses is given back by lobes
/// that are diffuse in shape (Kulla 2017), so no roughness darkens. A layer takes its albedo from what lies
/// below. Reciprocal: the base (metal, dielectric over diffuse, glass up to the factor eta^2 that radiance
/// leaves out). Not reciprocal: what lies below a coat or sheen, as that is weakened by the albedo for the
/// viewer's direction alone, and sheen itself.

#include "render/bsdf/ggx_albedo.h"
#include "render/bsdf/lobes.h"
#include "render/bsdf/principled_parameters.h"
#include "render/bsdf/sheen.h"

namespace oktett {

/// Interfaces with less roughness are smooth: alpha = roughness^2 < 0.001.
inline constexpr double kLeastRoughness = 0.0316;
/// Interfaces whose index of refraction is closer to 1 do not bend light.
inline constexpr double kLeastIorDifference = 1e-3;

class PrincipledLobes {
 public:
  PrincipledLobes(const PrincipledParameters& parameters, const Vec3f& wo, bool front);
  BsdfValue evaluate(const Vec3f& wi) const;
  std::optional<BsdfSample> sample(float lobe, const SquareSample& u) const;
  bool only_delta() const;

 private:
  /// kMirror: metal and opaque dielectric. kGlass: reflected or transmitted, as Fresnel's equations say.
  /// kAgainAbove, kAgainBelow: what single scattering loses, on the viewer's side and on the other.
  enum Lobe { kSheen, kCoat, kMirror, kGlass, kDiffuse, kAgainAbove, kAgainBelow, kLobes };

  struct Facets {
    double alpha = 0;      ///< width of the facets; 0: smooth
    double lambda = 0;     ///< ggx_lambda of the viewer
    double reflected = 0;  ///< ggx_reflected_scale of the viewer
  };
  struct Value {
    Vec3d value;
    double pdf = 0;
  };

  void set_layers(const PrincipledParameters& p, bool front);
  void set_metal(const PrincipledParameters& p);
  void set_opaque(const PrincipledParameters& p);
  void set_glass(const PrincipledParameters& p, bool front);
  Facets facets(double roughness) const;

  Vec3d metal_fresnel(double cosine) const;
  double glass_fresnel(double cosine) const;
  double chance_of_reflection(double glass_reflectance) const;
  Value above(const Vec3d& wi) const;
  Value below(const Vec3d& wi) const;
  Value transmitted(const Vec3d& wi) const;
  std::optional<BsdfSample> sample_glass(double place, const SquareSample& u) const;
  std::optional<BsdfSample> sample_smooth_glass(double place) const;

  Vec3d wo_;
  Vec3d base_color_, sheen_color_;
  Facets base_, coat_facets_;
  bool thin_, glass_smooth_ = true;
  double eta_ = 1;  ///< of glass, behind relative to before
  double opaque_eta_ = 1, coat_eta_ = 1;
  double sheen_ = 0, coat_ = 0, metal_ = 0, opaque_ = 0, glass_ = 0;  ///< weights, without what lies above
  bool has_conductor_ = false;
  Vec3d conductor_eta_, conductor_k_;
  SheenLobe fibres_;
  // Lobes of diffuse shape: coefficient * loss(wi) * |cos(wi)|.
  Vec3d metal_again_, diffuse_;
  double glass_again_above_ = 0;
  Vec3d glass_again_below_;
  MirrorAlbedo mirror_albedo_{0.25};
  std::optional<ReflectedAlbedo> opaque_albedo_;
  std::optional<GlassAlbedo> glass_albedo_, glass_albedo_behind_;
  LobeChoice<kLobes> choice_;
};

}  // namespace oktett
