#include "render/bsdf/principled_lobes.h"

#include "core/platform.h"
#include "render/bsdf/ggx.h"
#include "render/bsdf/optics.h"

namespace oktett {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Vec3d kWhite{1, 1, 1};

Vec3d mirrored(const Vec3d& w) { return {-w.x, -w.y, w.z}; }
Vec3d flipped(const Vec3d& w) { return {w.x, w.y, -w.z}; }

/// Fresnel's reflectance of metal from that head-on (Schlick 1994).
Vec3d schlick(const Vec3d& head_on, double cosine) {
  const double x = 1 - cosine, x5 = x * x * x * x * x;
  return head_on + (kWhite - head_on) * x5;
}

/// The fraction of diffuse light that metal reflects: the mean of `fresnel_of(cosine)` weighted by 2 cosine.
template <class Fresnel>
Vec3d mean_of(Fresnel&& fresnel_of) {
  // Gauss's rule of four points.
  static constexpr double kPoint[] = {0.0694318442029737, 0.330009478207572, 0.669990521792428,
                                      0.930568155797026};
  static constexpr double kWeight[] = {0.173927422568727, 0.326072577431273, 0.326072577431273,
                                       0.173927422568727};
  Vec3d sum;
  for (int i = 0; i < 4; ++i) sum += fresnel_of(kPoint[i]) * (2 * kPoint[i] * kWeight[i]);
  return sum;
}

/// What facets of albedo `mean` reflect of the light that single scattering loses, if each reflects `fresnel`
/// of diffuse light (Kulla 2017).
double reflected_again(double fresnel, double mean_loss) {
  return fresnel * fresnel * (1 - mean_loss) / (1 - fresnel * mean_loss);
}

/// The light that facets send to each other leaves them at grazing angles if they are narrow. A direction
/// above the surface whose cosine has a density in proportion to its power t: t = -1/2 for narrow facets, 0
/// for wider ones, 1 for the widest. Of these, each has the least variance in its range of alpha.
constexpr double kNarrow = 0.0625, kWide = 0.16;

Vec3d grazing_above(double alpha, const SquareSample& u) {
  if (alpha > kWide) return cosine_above(u);
  const double cosine = alpha > kNarrow ? u.x : u.x * u.x, sine = std::sqrt(1 - cosine * cosine);
  const double angle = 2 * kPi * u.y;
  return {sine * portable::cos(angle), sine * portable::sin(angle), cosine};
}

/// The density of `grazing_above` per solid angle.
double grazing_density(double cosine, double alpha) {
  if (alpha > kWide) return cosine / kPi;
  return alpha > kNarrow ? 1 / (2 * kPi) : 1 / (4 * kPi * std::sqrt(cosine));
}

}  // namespace

PrincipledLobes::PrincipledLobes(const PrincipledParameters& p, const Vec3f& wo, bool front)
    : wo_(direction_above(wo)), base_color_(limited(p.base_color, 0, 1)), thin_(p.thin) {
  base_ = facets(p.roughness);
  mirror_albedo_ = MirrorAlbedo(base_.alpha);
  set_layers(p, front);
  if (metal_ > 0) set_metal(p);
  if (opaque_ > 0) set_opaque(p);
  if (glass_ > 0) set_glass(p, front);
  choice_.normalize();
}

PrincipledLobes::Facets PrincipledLobes::facets(double roughness) const {
  const double rho = limited(roughness, 0, 1);
  if (rho < kLeastRoughness) return {};
  return {rho * rho, ggx_lambda(wo_, rho * rho), ggx_reflected_scale(wo_, rho * rho)};
}

/// Sheen and coat, and the weights of what lies below.
void PrincipledLobes::set_layers(const PrincipledParameters& p, bool front) {
  const double transmission = limited(p.transmission, 0, 1), metallic = limited(p.metallic, 0, 1);
  double left = 1;
  // A viewer inside glass sees neither.
  const bool on_this_side = front || thin_ || transmission == 0;
  sheen_color_ = limited(p.sheen_color, 0, 1) * limited(p.sheen, 0, 1);
  const double sheen = max_component(sheen_color_);
  if (on_this_side && sheen > 0) {
    fibres_ = SheenLobe(wo_, limited(p.sheen_roughness, 0, 1));
    choice_[kSheen] = sheen * fibres_.albedo();
    left -= choice_[kSheen];
  }
  coat_ = left * limited(p.coat, 0, 1);
  if (on_this_side && coat_ > 0) {
    coat_facets_ = facets(p.coat_roughness);
    coat_eta_ = limited(p.coat_ior, 1, kMostIor);
    choice_[kCoat] = coat_ * ReflectedAlbedo(coat_eta_, coat_facets_.alpha)(wo_.z);
    left -= choice_[kCoat];
  } else {
    coat_ = 0;
  }
  metal_ = left * metallic;
  opaque_ = left * (1 - metallic) * (1 - transmission);
  glass_ = left * (1 - metallic) * transmission;
}

void PrincipledLobes::set_metal(const PrincipledParameters& p) {
  has_conductor_ = p.conductor.has_value();
  if (has_conductor_)
    conductor_eta_ = limited(p.conductor->eta, 1e-3, 1e3), conductor_k_ = limited(p.conductor->k, 0, 1e3);
  // At least a little, since black metal is black head-on and white at grazing angles.
  choice_[kMirror] += metal_ * std::max(0.02, max_component(metal_fresnel(wo_.z)));
  const double loss = base_.alpha > 0 ? mirror_albedo_.mean_loss() : 0;
  if (!(loss > 0)) return;
  const Vec3d mean = has_conductor_ ? mean_of([&](double c) { return metal_fresnel(c); })
                                    : base_color_ + (kWhite - base_color_) * (1 / 21.0);
  const Vec3d again{reflected_again(mean.x, loss), reflected_again(mean.y, loss),
                    reflected_again(mean.z, loss)};
  const double lost_here = 1 - mirror_albedo_(wo_.z);
  metal_again_ = again * (metal_ * lost_here / (kPi * loss));
  choice_[kAgainAbove] += metal_ * max_component(again) * lost_here;
}

/// An interface over Lambert's law. The diffuse part takes what the interface does not reflect, for the
/// light's direction and for the viewer's (Kelemen 2001).
void PrincipledLobes::set_opaque(const PrincipledParameters& p) {
  const double ior = limited(p.ior, 1 / kMostIor, kMostIor), specular = limited(p.specular, 0, 1);
  const double r =
      std::min(std::abs(ior - 1) / (ior + 1) * std::sqrt(2 * specular), (kMostIor - 1) / (kMostIor + 1));
  opaque_eta_ = (1 + r) / (1 - r);
  opaque_albedo_.emplace(opaque_eta_, base_.alpha);
  const double reflected = (*opaque_albedo_)(wo_.z);
  choice_[kMirror] += opaque_ * std::max(r * r, reflected);
  diffuse_ = base_color_ * (opaque_ * (1 - reflected) / (kPi * opaque_albedo_->mean_loss()));
  choice_[kDiffuse] = opaque_ * max_component(base_color_) * (1 - reflected);
}

/// Glass. The light that single scattering loses is split between both sides such that the split is the same
/// backwards (Kulla 2017).
void PrincipledLobes::set_glass(const PrincipledParameters& p, bool front) {
  const double ior = limited(p.ior, 1 / kMostIor, kMostIor);
  eta_ = front || thin_ ? ior : 1 / ior;
  glass_smooth_ = base_.alpha == 0 || (!thin_ && std::abs(eta_ - 1) < kLeastIorDifference);
  const double tint = max_component(base_color_), reflectance = glass_fresnel(wo_.z);
  choice_[kGlass] = glass_ * std::max(0.02, reflectance + (1 - reflectance) * tint);
  if (glass_smooth_) return;
  const double high = std::max(eta_, 1 / eta_), transmittance = 1 - mean_fresnel(high);
  double lost_here, loss, loss_behind, passed;
  if (thin_) {
    lost_here = 1 - mirror_albedo_(wo_.z);
    loss = loss_behind = mirror_albedo_.mean_loss();
    passed = transmittance / (2 - transmittance);
  } else {
    glass_albedo_.emplace(eta_, base_.alpha), glass_albedo_behind_.emplace(1 / eta_, base_.alpha);
    lost_here = 1 - (*glass_albedo_)(wo_.z);
    loss = glass_albedo_->mean_loss(), loss_behind = glass_albedo_behind_->mean_loss();
    passed = transmittance * std::min(1.0, loss_behind / loss) / (eta_ > 1 ? 1 : high * high);
  }
  if (!(loss > 0 && loss_behind > 0)) return;
  glass_again_above_ = glass_ * (1 - passed) * lost_here / (kPi * loss);
  glass_again_below_ = base_color_ * (glass_ * passed * lost_here / (kPi * loss_behind));
  choice_[kAgainAbove] += glass_ * (1 - passed) * lost_here;
  choice_[kAgainBelow] = glass_ * passed * tint * lost_here;
}

Vec3d PrincipledLobes::metal_fresnel(double c) const {
  if (!has_conductor_) return schlick(base_color_, c);
  return {conductor_fresnel(c, conductor_eta_.x, conductor_k_.x),
          conductor_fresnel(c, conductor_eta_.y, conductor_k_.y),
          conductor_fresnel(c, conductor_eta_.z, conductor_k_.z)};
}

/// Of a thin wall: with all reflections inside it.
double PrincipledLobes::glass_fresnel(double c) const {
  const double f = std::min(1.0, fresnel(c, eta_));
  return thin_ ? 2 * f / (1 + f) : f;
}

/// Of a sample of glass.
double PrincipledLobes::chance_of_reflection(double reflectance) const {
  const double passed = (1 - reflectance) * max_component(base_color_);
  return passed > 0 ? reflectance / (reflectance + passed) : 1;
}

/// Facets: f cos of a reflecting lobe is F D G / (4 wo.z) with G = 1 / (1 + Lambda(wo) + Lambda(wi)).
PrincipledLobes::Value PrincipledLobes::above(const Vec3d& wi) const {
  Value sum;
  const Vec3d h = normalize(wo_ + wi);
  const double c = std::min(1.0, dot(wo_, h));
  if (base_.alpha > 0) {
    const double normals = ggx_density(h, base_.alpha), density = normals * base_.reflected;
    Vec3d reflectance;
    if (metal_ > 0) reflectance += metal_fresnel(c) * metal_;
    if (opaque_ > 0) reflectance += kWhite * (opaque_ * fresnel(c, opaque_eta_));
    sum.pdf += choice_[kMirror] * density;
    if (!glass_smooth_) {
      const double f = glass_fresnel(c), visible = normals / (4 * wo_.z * (1 + base_.lambda));
      reflectance += kWhite * (glass_ * f);
      sum.pdf += choice_[kGlass] * chance_of_reflection(f) * (thin_ ? density : visible);
    }
    sum.value += reflectance * (normals / (4 * wo_.z * (1 + base_.lambda + ggx_lambda(wi, base_.alpha))));
  }
  if (coat_facets_.alpha > 0) {
    const double normals = ggx_density(h, coat_facets_.alpha), lambda = ggx_lambda(wi, coat_facets_.alpha);
    const double weight = coat_ * fresnel(c, coat_eta_);
    sum.value += kWhite * (weight * normals / (4 * wo_.z * (1 + coat_facets_.lambda + lambda)));
    sum.pdf += choice_[kCoat] * normals * coat_facets_.reflected;
  }
  if (opaque_ > 0) {
    sum.value += diffuse_ * ((1 - (*opaque_albedo_)(wi.z)) * wi.z);
    sum.pdf += choice_[kDiffuse] * wi.z / kPi;
  }
  if (choice_[kAgainAbove] > 0) {
    Vec3d again;
    if (max_component(metal_again_) > 0) again += metal_again_ * (1 - mirror_albedo_(wi.z));
    if (glass_again_above_ > 0)
      again += kWhite * (glass_again_above_ * (1 - (thin_ ? mirror_albedo_(wi.z) : (*glass_albedo_)(wi.z))));
    sum.value += again * wi.z;
    sum.pdf += choice_[kAgainAbove] * grazing_density(wi.z, base_.alpha);
  }
  if (choice_[kSheen] > 0) {
    const double density = fibres_.density(wi);
    sum.value += sheen_color_ * (fibres_.albedo() * density);
    sum.pdf += choice_[kSheen] * density;
  }
  return sum;
}

/// Transmission through facets (Walter 2007), without the factor eta^2 of radiance. Through a thin wall it is
/// reflection with the light on the other side.
PrincipledLobes::Value PrincipledLobes::transmitted(const Vec3d& wi) const {
  Vec3d h = thin_ ? wo_ + flipped(wi) : wo_ + wi * eta_;
  const double size = length(h);
  if (!(size > 0)) return {};
  h = h / (h.z < 0 ? -size : size);
  const double c = std::min(1.0, dot(wo_, h)), d = dot(wi, h);
  const double reflectance = glass_fresnel(c), normals = ggx_density(h, base_.alpha);
  double facing, density;
  if (thin_) {
    facing = normals / (4 * wo_.z);
    density = normals * base_.reflected;
  } else {
    if (!(c > 0 && d < 0)) return {};
    const double t = c + eta_ * d;
    facing = normals * c / wo_.z * eta_ * eta_ * -d / (t * t);
    density = facing / (1 + base_.lambda);
  }
  const double shown = facing / (1 + base_.lambda + ggx_lambda(wi, base_.alpha));
  return {base_color_ * (glass_ * (1 - reflectance) * shown),
          choice_[kGlass] * (1 - chance_of_reflection(reflectance)) * density};
}

PrincipledLobes::Value PrincipledLobes::below(const Vec3d& wi) const {
  if (glass_smooth_) return {};
  Value sum = transmitted(wi);
  if (choice_[kAgainBelow] > 0) {
    const double albedo = thin_ ? mirror_albedo_(-wi.z) : (*glass_albedo_behind_)(-wi.z);
    sum.value += glass_again_below_ * ((1 - albedo) * -wi.z);
    sum.pdf += choice_[kAgainBelow] * grazing_density(-wi.z, base_.alpha);
  }
  return sum;
}

OKTETT_NOINLINE BsdfValue PrincipledLobes::evaluate(const Vec3f& wi) const {
  if (!(wi.z > 0 || wi.z < 0)) return {};
  const Vec3d w = normalize(Vec3d(wi));
  const Value sum = wi.z > 0 ? above(w) : below(w);
  return {Color(sum.value), static_cast<float>(sum.pdf)};
}

bool PrincipledLobes::only_delta() const {
  return choice_[kSheen] == 0 && choice_[kDiffuse] == 0 && choice_[kAgainAbove] == 0 &&
         choice_[kAgainBelow] == 0 && (choice_[kCoat] == 0 || coat_facets_.alpha == 0) &&
         (choice_[kMirror] == 0 || base_.alpha == 0) && (choice_[kGlass] == 0 || glass_smooth_);
}

std::optional<BsdfSample> PrincipledLobes::sample(float lobe, const SquareSample& u) const {
  double place = lobe;
  const int chosen = choice_.pick(place);
  if (chosen == kSheen) return sample_of(*this, fibres_.sample(u));
  if (chosen == kDiffuse) return sample_of(*this, cosine_above(u));
  if (chosen == kAgainAbove) return sample_of(*this, grazing_above(base_.alpha, u));
  if (chosen == kAgainBelow) return sample_of(*this, flipped(grazing_above(base_.alpha, u)));
  if (chosen == kGlass) return glass_smooth_ ? sample_smooth_glass(place) : sample_glass(place, u);
  if (chosen < 0) return std::nullopt;
  const double alpha = chosen == kCoat ? coat_facets_.alpha : base_.alpha;
  if (alpha == 0) {
    const Vec3d weight =
        chosen == kCoat ? kWhite * (coat_ * fresnel(wo_.z, coat_eta_))
                        : metal_fresnel(wo_.z) * metal_ + kWhite * (opaque_ * fresnel(wo_.z, opaque_eta_));
    return delta_sample(mirrored(wo_), weight, choice_[chosen]);
  }
  const Vec3d m = ggx_reflecting_normal(wo_, alpha, u), wi = m * (2 * dot(wo_, m)) - wo_;
  return wi.z > 0 ? sample_of(*this, wi) : std::nullopt;
}

std::optional<BsdfSample> PrincipledLobes::sample_smooth_glass(double place) const {
  const double reflectance = glass_fresnel(wo_.z), chance = chance_of_reflection(reflectance);
  if (place < chance)
    return delta_sample(mirrored(wo_), kWhite * (glass_ * reflectance), choice_[kGlass] * chance);
  Vec3d wi = -wo_;
  if (!thin_) {
    wi = wi / eta_;
    wi.z = -std::sqrt(std::max(0.0, 1 - (wi.x * wi.x + wi.y * wi.y)));
  }
  return delta_sample(wi, base_color_ * (glass_ * (1 - reflectance)), choice_[kGlass] * (1 - chance));
}

std::optional<BsdfSample> PrincipledLobes::sample_glass(double place, const SquareSample& u) const {
  const Vec3d m =
      thin_ ? ggx_reflecting_normal(wo_, base_.alpha, u) : ggx_visible_normal(wo_, base_.alpha, u);
  const double c = dot(wo_, m), reflectance = glass_fresnel(c);
  const bool reflect = place < chance_of_reflection(reflectance);
  if (reflect || thin_) {
    const Vec3d wi = m * (2 * c) - wo_;
    if (!(wi.z > 0)) return std::nullopt;
    return sample_of(*this, reflect ? wi : flipped(wi));
  }
  const double cos_behind = std::sqrt(std::max(0.0, 1 - (1 - c * c) / (eta_ * eta_)));
  const Vec3d wi = m * (c / eta_ - cos_behind) - wo_ * (1 / eta_);
  return wi.z < 0 ? sample_of(*this, wi) : std::nullopt;
}

}  // namespace oktett
