#pragma once
/// \file What one side of a surface of the principled material needs, whatever the directions.

#include "render/bsdf/ggx_albedo.h"
#include "render/bsdf/principled_parameters.h"

namespace oktett {

/// Interfaces with less roughness are smooth: alpha = roughness^2 < 0.001.
inline constexpr double kLeastRoughness = 0.0316;
/// Interfaces whose index of refraction is closer to 1 do not bend light.
inline constexpr double kLeastIorDifference = 1e-3;

/// Whether glass of these parameters passes light without scattering it: smooth glass, and glass that does
/// not bend light.
bool is_smooth_glass(const PrincipledParameters& parameters);

struct PrincipledSurface {
  PrincipledSurface() = default;
  /// `front`: the viewer is outside, where the geometric normal points to.
  PrincipledSurface(const PrincipledParameters& parameters, bool front);

  Vec3d base_color;
  double tint = 0;  ///< greatest component of base_color
  bool thin = false;
  double alpha = 0;        ///< width of the facets; 0: smooth
  MirrorAlbedo mirror;     ///< of these facets
  double mirror_loss = 0;  ///< its mean loss

  Vec3d sheen_color;
  double sheen = 0;  ///< greatest component of sheen_color; 0 for viewers inside glass, as is `coat`
  double sheen_roughness = 0;

  double coat = 0, coat_alpha = 0, coat_eta = 1;
  ReflectedAlbedo coat_albedo;

  double metal = 0, opaque = 0, glass = 0;  ///< weights, which add to 1

  bool has_conductor = false;
  Vec3d conductor_eta, conductor_k;
  Vec3d metal_again;            ///< what facets reflect of the light that they send to each other
  double metal_again_most = 0;  ///< its greatest component; 0: there is no such light
  MirrorAgain again;

  double opaque_eta = 1, opaque_head_on = 0;  ///< index of refraction; reflectance head-on
  ReflectedAlbedo opaque_albedo;

  double eta = 1;  ///< of glass, behind relative to before
  bool glass_smooth = true;
  GlassAlbedo glass_albedo, glass_albedo_behind;
  double loss = 0, loss_behind = 0;  ///< mean losses of these, or of mirrors for thin glass
  double passed = 0;                 ///< which part of the light that single scattering loses is transmitted

 private:
  void set_metal(const PrincipledParameters& p);
  void set_glass(const PrincipledParameters& p, bool front);
};

/// Fresnel's reflectance of metal from that head-on (Schlick 1994).
template <class D>
OKTETT_INLINE Vec3<D> schlick(const Vec3d& head_on, const D& cosine) {
  const D x = D(1.0) - cosine, x5 = x * x * x * x * x;
  const auto part = [&](double h) { return D(h) + D(1 - h) * x5; };
  return {part(head_on.x), part(head_on.y), part(head_on.z)};
}

}  // namespace oktett
