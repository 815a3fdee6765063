#include "render/bsdf/phong_lobes.h"

#include "core/platform.h"
#include "render/bsdf/optics.h"
#include "render/bsdf/phong_power.h"

namespace oktett {

static constexpr double kMost = 1e9;

PhongLobes::PhongLobes(const PhongParameters& parameters, const Vec3f& wo, bool front) {
  const Vec3d w = direction_above(wo);
  const Vec3d color = limited(parameters.color, 0, kMost);
  const Vec3d specular_color = limited(parameters.specular_color, 0, kMost);
  const double transparency = limited(parameters.transparency, 0, kMost);
  mirrored_viewer_ = {-w.x, -w.y, w.z};
  exponent_ = limited(parameters.phong, 0, kMost);
  diffuse_ = color * limited(parameters.diffuse, 0, kMost);
  highlight_ = specular_color * limited(parameters.specular, 0, kMost);
  mirror_ = specular_color * limited(parameters.reflection, 0, kMost);
  if (transparency > 0) {
    const double ior = limited(parameters.ior, 1e-3, 1e3);
    const auto eta = static_cast<float>(front ? ior : 1 / ior);
    const std::optional<Vec3f> direction = refract(-Vec3f(w), {0, 0, 1}, eta);
    const double reflectance = direction ? fresnel(static_cast<float>(w.z), eta) : 1;
    mirror_ += Vec3d{1, 1, 1} * (transparency * reflectance);
    if (direction) {
      refracted_direction_ = Vec3d(*direction);
      refracted_ = color * (transparency * (1 - reflectance));
    }
  }
  choice_[kDiffuse] = max_component(diffuse_);
  choice_[kHighlight] = max_component(highlight_) * 2 / (exponent_ + 1);
  choice_[kMirror] = max_component(mirror_);
  choice_[kRefracted] = max_component(refracted_);
  choice_.normalize();
}

OKTETT_NOINLINE BsdfValue PhongLobes::evaluate(const Vec3f& wi) const {
  if (!(wi.z > 0)) return {};
  const Vec3d w = normalize(Vec3d(wi));
  Vec3d value = diffuse_ * w.z;
  double pdf = choice_[kDiffuse] * w.z;
  const double cosine = std::min(1.0, dot(mirrored_viewer_, w));
  if (choice_[kHighlight] > 0 && cosine > 0) {
    const double shine = phong_power(cosine, exponent_);
    value += highlight_ * shine;
    pdf += choice_[kHighlight] * (exponent_ + 1) / 2 * shine;
  }
  return {Color(value / std::numbers::pi), static_cast<float>(pdf / std::numbers::pi)};
}

std::optional<BsdfSample> PhongLobes::sample(float lobe, const SquareSample& u) const {
  double place = lobe;
  const int chosen = choice_.pick(place);
  if (chosen == kMirror) return delta_sample(mirrored_viewer_, mirror_, choice_[kMirror]);
  if (chosen == kRefracted) return delta_sample(refracted_direction_, refracted_, choice_[kRefracted]);
  if (chosen == kDiffuse) return sample_of(*this, cosine_above(u));
  if (chosen != kHighlight) return std::nullopt;
  // The cosine to the mirrored viewer is u^(1 / (exponent + 1)).
  const double cosine = portable::pow(1 - u.x, 1 / (exponent_ + 1));
  const double sine = std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
  const double angle = 2 * std::numbers::pi * u.y;
  Vec3d tangent, bitangent;
  make_basis(mirrored_viewer_, tangent, bitangent);
  return sample_of(*this, normalize(tangent * (sine * portable::cos(angle)) +
                                    bitangent * (sine * portable::sin(angle)) + mirrored_viewer_ * cosine));
}

}  // namespace oktett
