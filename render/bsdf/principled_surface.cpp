#include "render/bsdf/principled_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/bsdf/lobes.h"
#include "render/bsdf/optics.h"

namespace oktett {

static constexpr Vec3d kWhite{1, 1, 1};

/// The fraction of diffuse light that metal reflects: the mean of `fresnel_of(cosine)` weighted by 2 cosine.
template <class Fresnel>
static Vec3d mean_of(Fresnel&& fresnel_of) {
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
static double reflected_again(double fresnel, double mean_loss) {
  return fresnel * fresnel * (1 - mean_loss) / (1 - fresnel * mean_loss);
}

static double facet_width(double roughness) {
  const double rho = limited(roughness, 0, 1);
  return rho < kLeastRoughness ? 0 : rho * rho;
}

bool is_smooth_glass(const PrincipledParameters& p) {
  const double ior = limited(p.ior, 1 / kMostIor, kMostIor);
  // By the greater of the two indices, so that both sides agree.
  return facet_width(p.roughness) == 0 || (!p.thin && std::max(ior, 1 / ior) - 1 < kLeastIorDifference);
}

PrincipledSurface::PrincipledSurface(const PrincipledParameters& p, bool front)
    : base_color(limited(p.base_color, 0, 1)),
      tint(max_component(base_color)),
      thin(p.thin),
      alpha(facet_width(p.roughness)),
      mirror(alpha),
      mirror_loss(mirror.mean_loss()) {
  const double transmission = limited(p.transmission, 0, 1), metallic = limited(p.metallic, 0, 1);
  metal = metallic, opaque = (1 - metallic) * (1 - transmission), glass = (1 - metallic) * transmission;
  // A viewer inside glass sees neither sheen nor coat.
  if (front || thin || transmission == 0) {
    sheen_color = limited(p.sheen_color, 0, 1) * limited(p.sheen, 0, 1);
    sheen = max_component(sheen_color);
    sheen_roughness = limited(p.sheen_roughness, 0, 1);
    coat = limited(p.coat, 0, 1);
  }
  if (coat > 0) {
    coat_alpha = facet_width(p.coat_roughness);
    coat_eta = limited(p.coat_ior, 1, kMostIor);
    coat_albedo = ReflectedAlbedo(coat_eta, coat_alpha);
  }
  const double ior = limited(p.ior, 1 / kMostIor, kMostIor);
  if (opaque > 0) {
    const double specular = limited(p.specular, 0, 1);
    const double r =
        std::min(std::abs(ior - 1) / (ior + 1) * std::sqrt(2 * specular), (kMostIor - 1) / (kMostIor + 1));
    opaque_eta = (1 + r) / (1 - r), opaque_head_on = r * r;
    opaque_albedo = ReflectedAlbedo(opaque_eta, alpha);
  }
  if (metal > 0) set_metal(p);
  if (glass > 0) set_glass(p, front);
}

void PrincipledSurface::set_metal(const PrincipledParameters& p) {
  has_conductor = p.conductor.has_value();
  if (has_conductor)
    conductor_eta = limited(p.conductor->eta, 1e-3, 1e3), conductor_k = limited(p.conductor->k, 0, 1e3);
  if (!(mirror_loss > 0)) return;
  again = MirrorAgain(alpha);
  const auto of_conductor = [&](double c) {
    return Vec3d{conductor_fresnel(c, conductor_eta.x, conductor_k.x),
                 conductor_fresnel(c, conductor_eta.y, conductor_k.y),
                 conductor_fresnel(c, conductor_eta.z, conductor_k.z)};
  };
  const Vec3d mean = has_conductor ? mean_of(of_conductor) : base_color + (kWhite - base_color) * (1 / 21.0);
  metal_again = {reflected_again(mean.x, mirror_loss), reflected_again(mean.y, mirror_loss),
                 reflected_again(mean.z, mirror_loss)};
  metal_again_most = max_component(metal_again);
}

/// The light that single scattering loses is split between both sides such that the split is the same
/// backwards (Kulla 2017).
void PrincipledSurface::set_glass(const PrincipledParameters& p, bool front) {
  const double ior = limited(p.ior, 1 / kMostIor, kMostIor);
  eta = front || thin ? ior : 1 / ior;
  glass_smooth = is_smooth_glass(p);
  if (glass_smooth) return;
  const double high = std::max(eta, 1 / eta), transmittance = 1 - mean_fresnel(high);
  if (thin) {
    loss = loss_behind = mirror_loss;
    passed = transmittance / (2 - transmittance);
  } else {
    glass_albedo = GlassAlbedo(eta, alpha), glass_albedo_behind = GlassAlbedo(1 / eta, alpha);
    loss = glass_albedo.mean_loss(), loss_behind = glass_albedo_behind.mean_loss();
    passed = transmittance * std::min(1.0, loss_behind / loss) / (eta > 1 ? 1 : high * high);
  }
}

}  // namespace oktett
