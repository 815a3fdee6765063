#pragma once
/// \file Phong's illumination model with ideal mirrors and glass, as of Material, for light of unit radiance.

#include "render/bsdf/lobes.h"

namespace oktett {

/// Weights are in [0, inf); they are clamped to 1e9. A sum above 1 gains energy.
struct PhongParameters {
  Color color{0.8f, 0.8f, 0.8f};  ///< of diffuse light and of light that passes through
  Color specular_color{1, 1, 1};  ///< of the highlight and of the mirror
  float diffuse = 0.8f;
  float specular = 0;      ///< weight of the highlight
  float phong = 32;        ///< exponent of the highlight, [0, inf)
  float reflection = 0;    ///< weight of the mirror
  float transparency = 0;  ///< weight of smooth glass
  float ior = 1.5f;        ///< index of refraction behind the front side relative to before it, > 0
};

/// The sum of (Phong 1975, each light as it is lit by lamps divided by pi)
/// - color * diffuse * cos(wi) / pi,
/// - specular_color * specular * max(0, r.wi)^phong / pi, r the mirrored viewer. As light is not
/// foreshortened
///   here, this lobe is not reciprocal;
/// - a mirror: specular_color * reflection;
/// - glass: transparency, of which Fresnel's fraction is reflected and the rest, times color, refracted.
class PhongLobes {
 public:
  PhongLobes(const PhongParameters& parameters, const Vec3f& wo, bool front);
  BsdfValue evaluate(const Vec3f& wi) const;
  std::optional<BsdfSample> sample(float lobe, const SquareSample& u) const;
  bool only_delta() const { return choice_[kDiffuse] == 0 && choice_[kHighlight] == 0; }

 private:
  enum Lobe { kDiffuse, kHighlight, kMirror, kRefracted, kLobes };

  Vec3d mirrored_viewer_, refracted_direction_;
  Vec3d diffuse_, highlight_, mirror_, refracted_;
  double exponent_;
  LobeChoice<kLobes> choice_;
};

}  // namespace oktett
