#pragma once
/// \file Phong's illumination model with ideal mirrors and glass, as of Material, for light of unit radiance.

#include <optional>

#include "core/math.h"
#include "render/bsdf/lobe_lanes.h"

namespace oktett {

/// Whole exponents up to 1024 are raised to by squaring; most materials have such exponents.
inline bool by_squaring(double exponent) {
  return exponent >= 0 && exponent <= 1024 &&
         static_cast<double>(static_cast<unsigned>(exponent)) == exponent;
}

/// `cosine`, in [0, 1] or NaN, to the power of a material's exponent.
inline double phong_power(double cosine, double exponent) {
  return by_squaring(exponent) ? portable::whole_power(cosine, static_cast<unsigned>(exponent))
                               : portable::pow(cosine, exponent);
}

/// Weights are in [0, inf); they are clamped to 1e9. A sum above 1 gains energy.
struct PhongParameters {
  Color color{0.8f, 0.8f, 0.8f};  ///< of diffuse light
  Color specular_color{1, 1, 1};  ///< of the highlight and of the mirror
  float diffuse = 0.8f;
  float specular = 0;             ///< weight of the highlight
  float phong = 32;               ///< exponent of the highlight, [0, inf)
  float reflection = 0;           ///< weight of the mirror
  float transparency = 0;         ///< weight of smooth glass
  std::optional<Color> filter{};  ///< of light that passes through; not given: color
  float ior = 1.5f;               ///< index of refraction behind the front side relative to before it, > 0
  float brilliance = 1;           ///< power of the cosine of diffuse light, [0, inf)
  float specular_blinn = 0;       ///< weight of the highlight about the halfway direction
  float blinn = 128;              ///< its exponent, [0, inf)
  std::optional<Color> mirror_color{};  ///< not given: specular_color
};

/// What one side of a surface needs, whatever the directions.
struct PhongSurface {
  PhongSurface() = default;
  /// `front`: the viewer is outside, where the geometric normal points to.
  OKTETT_INLINE PhongSurface(const PhongParameters& parameters, bool front)
      : filter(limited(parameters.filter.value_or(parameters.color), 0, kMost)),
        exponent(limited(parameters.phong, 0, kMost)),
        brilliance(limited(parameters.brilliance, 0, kMost)),
        blinn(limited(parameters.blinn, 0, kMost)),
        transparency(limited(parameters.transparency, 0, kMost)) {
    const Vec3d specular_color = limited(parameters.specular_color, 0, kMost);
    diffuse = limited(parameters.color, 0, kMost) * limited(parameters.diffuse, 0, kMost);
    highlight = specular_color * limited(parameters.specular, 0, kMost);
    halfway = specular_color * limited(parameters.specular_blinn, 0, kMost);
    mirror = (parameters.mirror_color ? limited(*parameters.mirror_color, 0, kMost) : specular_color) *
             limited(parameters.reflection, 0, kMost);
    const double ior = limited(parameters.ior, 1e-3, 1e3);
    eta = static_cast<float>(front ? ior : 1 / ior);
    only_diffuse = max_component(diffuse) > 0 && highlight == Vec3d{} && halfway == Vec3d{} &&
                   mirror == Vec3d{} && transparency == 0 && brilliance == 1;
  }

  static constexpr double kMost = 1e9;
  Vec3d filter, diffuse, highlight, halfway, mirror;
  double exponent = 0, brilliance = 1, blinn = 0, transparency = 0, eta = 1;
  bool only_diffuse = false;  ///< all other lobes are black

  /// Whether its lobes are black but in finitely many directions.
  bool only_delta() const { return diffuse == Vec3d{} && highlight == Vec3d{} && halfway == Vec3d{}; }
  /// Whether light may pass to the other side.
  bool transmits() const { return transparency > 0; }
};

/// The sum of (Phong 1975, each light as it is lit by emitters divided by pi)
/// - color * diffuse * cos(wi)^brilliance / pi,
/// - specular_color * specular * max(0, r.wi)^phong / pi, r the mirrored viewer. As light is not
///   foreshortened here, this lobe is not reciprocal;
/// - specular_color * specular_blinn * max(0, n.h)^blinn / pi, h halfway between wi and the viewer, likewise;
/// - a mirror: mirror_color * reflection;
/// - glass: transparency, of which Fresnel's fraction is reflected and the rest, times filter, refracted.
///
/// In lanes of doubles D, for viewers of the same surface.
template <class D>
class PhongLobes {
 public:
  using F = FloatsOf<D>;
  using Surface = PhongSurface;

  PhongLobes(const PhongSurface& surface, const Vec3<F>& wo) : s_(&surface) {
    choice_[kDiffuse] = D(surface.only_diffuse ? 1.0 : 0.0);
    if (surface.only_diffuse) return;
    const Vec3<D> w = direction_above<D>(wo);
    mirrored_viewer_ = {-w.x, -w.y, w.z};
    mirror_ = broadcast<D>(s_->mirror);
    if (s_->transparency > 0) set_glass(w);
    choice_[kDiffuse] = D(max_component(s_->diffuse) * 2 / (s_->brilliance + 1));
    choice_[kHighlight] = D(max_component(s_->highlight) * 2 / (s_->exponent + 1));
    choice_[kHalfway] = w.z * D(max_component(s_->halfway) * 8 / (s_->blinn + 1));
    choice_[kMirror] = max(max(mirror_.x, mirror_.y), mirror_.z);
    choice_[kRefracted] = max(max(refracted_.x, refracted_.y), refracted_.z);
    choice_.normalize();
  }

  /// Value and density of the lobes that are not delta. Not inlined: GCC 12 would leave out the rounding of
  /// directions to float and back.
  OKTETT_NOINLINE BsdfValues<D> evaluate(const Vec3<F>& wi) const {
    const D zero(0.0);
    const auto above = wi.z > F(0.0f);
    const Vec3<D> w = unit_lanes(to_double(wi));
    const D falling = s_->brilliance == 1 ? w.z : power_lanes(min(D(1.0), max(zero, w.z)), s_->brilliance);
    Vec3<D> value = broadcast<D>(s_->diffuse) * falling;
    D pdf = choice_[kDiffuse] * D((s_->brilliance + 1) / 2) * falling;
    if (s_->only_diffuse) return lit(above, value, pdf);
    if (any(choice_[kHalfway] > zero)) add_halfway(w, value, pdf);
    const D cosine = min(D(1.0), dot_lanes(mirrored_viewer_, w));
    const auto shines = (choice_[kHighlight] > zero) & (cosine > zero);
    if (any(shines)) {
      const D shine = select(shines, power_lanes(select(shines, cosine, D(1.0)), s_->exponent), zero);
      value = value + broadcast<D>(s_->highlight) * shine;
      pdf = pdf + choice_[kHighlight] * D((s_->exponent + 1) / 2) * shine;
    }
    return lit(above, value, pdf);
  }

  /// As Bsdf::sample.
  BsdfSamples<D> sample(const D& lobe, const D& x, const D& y) const {
    if (s_->only_diffuse) return sample_diffuse(x, y);
    D place = lobe;
    const D chosen = choice_.pick(place);
    const auto diffuse = chosen == D(kDiffuse), highlight = chosen == D(kHighlight);
    const auto halfway = chosen == D(kHalfway);
    const auto mirror = chosen == D(kMirror), refracted = chosen == D(kRefracted);
    Vec3<D> direction = mirrored_viewer_;
    if (any(diffuse)) direction = select_lanes(diffuse, diffuse_direction(x, y, bits(diffuse)), direction);
    if (any(highlight))
      direction = select_lanes(
          highlight, direction_about(mirrored_viewer_, s_->exponent, x, y, bits(highlight)), direction);
    if (any(halfway)) direction = select_lanes(halfway, by_halfway(x, y, bits(halfway)), direction);
    if (any(refracted)) direction = select_lanes(refracted, refracted_direction_, direction);
    BsdfSamples<D> sample;
    sample.direction = to_float(direction);
    sample.transmitted = sample.direction.z < F(0.0f);
    const auto scattered = mask_cast<float>(diffuse | highlight | halfway);
    sample.found = scattered;
    sample.pdf = F(0.0f);
    sample.weight = {F(0.0f), F(0.0f), F(0.0f)};
    if (any(scattered)) {
      const BsdfValues<D> at = evaluate(sample.direction);
      sample.found = scattered & (at.pdf > F(0.0f));
      sample.weight = {at.value.x / at.pdf, at.value.y / at.pdf, at.value.z / at.pdf};
      sample.pdf = select(scattered, at.pdf, F(0.0f));
    }
    add_delta(sample, mirror, mirror_, choice_[kMirror]);
    add_delta(sample, refracted, refracted_, choice_[kRefracted]);
    return sample;
  }

  /// The lanes in which `sample` chooses the diffuse lobe.
  typename D::M chooses_diffuse(D lobe) const {
    return s_->only_diffuse ? lobe == lobe : choice_.pick(lobe) == D(kDiffuse);
  }

  /// The lanes in which `evaluate` is black everywhere.
  typename F::M only_delta() const {
    return mask_cast<float>((choice_[kDiffuse] == D(0.0)) & (choice_[kHighlight] == D(0.0)) &
                            (choice_[kHalfway] == D(0.0)));
  }

  bool transmits() const { return s_->transmits(); }

  /// After the surface has been copied to another place.
  void rebind(const PhongSurface& surface) { s_ = &surface; }

 private:
  enum Lobe { kDiffuse, kHighlight, kHalfway, kMirror, kRefracted, kLobes };

  /// Value and density times pi, where the light is above the surface.
  static BsdfValues<D> lit(const typename F::M& above, const Vec3<D>& value, const D& pdf) {
    const D share(1 / std::numbers::pi);
    const F dark(0.0f);
    return {select_lanes(above, to_float(value * share), Vec3<F>{dark, dark, dark}),
            select(above, to_float(pdf * share), dark)};
  }

  BsdfSamples<D> sample_diffuse(const D& x, const D& y) const {
    const Vec3<D> direction = cosine_above(x, y);
    BsdfSamples<D> sample;
    sample.direction = to_float(direction);
    sample.transmitted = sample.direction.z < F(0.0f);
    sample.weight = to_float(broadcast<D>(s_->diffuse));
    sample.pdf = to_float(direction.z * D(1 / std::numbers::pi));
    sample.found = sample.pdf > F(0.0f);
    return sample;
  }

  void set_glass(const Vec3<D>& w) {
    const D eta(s_->eta), ratio(1 / s_->eta), zero(0.0);
    const D sin2_out = ratio * ratio * (D(1.0) - w.z * w.z);
    const auto passes = (sin2_out < D(1.0)) | (eta == D(1.0));
    const D cos_out = sqrt(max(zero, D(1.0) - sin2_out));
    refracted_direction_ = unit_lanes(Vec3<D>{-w.x * ratio, -w.y * ratio, -cos_out});
    const D reflectance = select(passes, min(D(1.0), fresnel_lanes(w.z, eta)), D(1.0));
    const D reflected = D(s_->transparency) * reflectance;
    mirror_ = mirror_ + Vec3<D>{reflected, reflected, reflected};
    refracted_ =
        broadcast<D>(s_->filter) * select(passes, D(s_->transparency) * (D(1.0) - reflectance), zero);
  }

  /// `cosine` in [0, 1] to the power of the exponent.
  static D power_lanes(const D& cosine, double exponent) {
    if (by_squaring(exponent)) {
      D product(1.0), x = cosine;
      for (auto n = static_cast<unsigned>(exponent); n != 0; n >>= 1, x = x * x)
        if (n & 1) product = product * x;
      return product;
    }
    double lanes[D::kWidth];
    cosine.store(lanes);
    for (double& lane : lanes) lane = portable::pow(lane, exponent);
    return D::load(lanes);
  }

  /// Directions about the unit vector `axis`, right in the lanes `which`: the cosine to it is
  /// (1 - x)^(1 / (exponent + 1)).
  static Vec3<D> direction_about(const Vec3<D>& axis, double exponent, const D& x, const D& y,
                                 unsigned which) {
    double lanes[D::kWidth];
    x.store(lanes);
    for (int k = 0; k < D::kWidth; ++k)
      lanes[k] = which >> k & 1 ? portable::pow(1 - lanes[k], 1 / (exponent + 1)) : 1;
    const D cosine = D::load(lanes), size = sqrt(max(D(0.0), (D(1.0) - cosine) * (D(1.0) + cosine)));
    D sine_turn, cosine_turn;
    sin_cos_of_turn(y, sine_turn, cosine_turn);
    Vec3<D> tangent, bitangent;
    basis_lanes(axis, tangent, bitangent);
    return unit_lanes(tangent * (size * cosine_turn) + bitangent * (size * sine_turn) + axis * cosine);
  }

  static Vec3<D> up() { return {D(0.0), D(0.0), D(1.0)}; }
  Vec3<D> viewer() const { return {-mirrored_viewer_.x, -mirrored_viewer_.y, mirrored_viewer_.z}; }

  Vec3<D> diffuse_direction(const D& x, const D& y, unsigned which) const {
    if (s_->brilliance == 1) return cosine_above(x, y);
    return direction_about(up(), s_->brilliance, x, y, which);
  }

  /// The viewer mirrored by a direction about the normal.
  Vec3<D> by_halfway(const D& x, const D& y, unsigned which) const {
    const Vec3<D> h = direction_about(up(), s_->blinn, x, y, which), v = viewer();
    const D twice = D(2.0) * dot_lanes(h, v);
    return unit_lanes(Vec3<D>{h.x * twice - v.x, h.y * twice - v.y, h.z * twice - v.z});
  }

  /// Adds the lobe about the halfway direction towards the unit vector `w` to value and density, both times
  /// pi.
  void add_halfway(const Vec3<D>& w, Vec3<D>& value, D& pdf) const {
    const D zero(0.0), one(1.0);
    const Vec3<D> v = viewer(), sum{v.x + w.x, v.y + w.y, v.z + w.z};
    const D size = sqrt(max(zero, dot_lanes(sum, sum)));
    const auto there = size > D(1e-9);
    const D length = select(there, size, one), cosine = max(zero, min(one, sum.z / length));
    const D shine = select(there, power_lanes(cosine, s_->blinn), zero);
    // The cosine between the halfway direction and the viewer is half the length of the sum.
    value = value + broadcast<D>(s_->halfway) * shine;
    pdf = pdf + choice_[kHalfway] * D((s_->blinn + 1) / 2) * shine / (D(2.0) * length);
  }

  static void add_delta(BsdfSamples<D>& sample, const typename D::M& chosen, const Vec3<D>& coefficient,
                        const D& probability) {
    if (none(chosen)) return;
    const auto lanes = mask_cast<float>(chosen);
    const Vec3<D> weight{coefficient.x / probability, coefficient.y / probability,
                         coefficient.z / probability};
    sample.found = sample.found | lanes;
    sample.weight = select_lanes(lanes, to_float(weight), sample.weight);
  }

  const PhongSurface* s_;
  Vec3<D> mirrored_viewer_, refracted_direction_, mirror_;
  Vec3<D> refracted_{D(0.0), D(0.0), D(0.0)};
  LobeChances<D, kLobes> choice_;
};

}  // namespace oktett
