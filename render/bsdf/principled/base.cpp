#include "render/bsdf/principled/base.h"

#include <algorithm>
#include <cmath>

namespace oktett {

double facet_width(double roughness) {
  const double rho = limited(roughness, 0, 1);
  return rho < kLeastRoughness ? 0 : rho * rho;
}

static double limited_ior(const PrincipledParameters& p) { return limited(p.ior, 1 / kMostIor, kMostIor); }

bool is_smooth_glass(const PrincipledParameters& p) {
  const double ior = limited_ior(p);
  // By the greater of the two indices, so that both sides agree.
  return facet_width(p.roughness) == 0 || (!p.thin && std::max(ior, 1 / ior) - 1 < kLeastIorDifference);
}

PrincipledBase::PrincipledBase(const PrincipledParameters& p, bool is_front)
    : base_color(limited(p.base_color, 0, 1)),
      tint(max_component(base_color)),
      front(is_front),
      thin(p.thin),
      alpha(facet_width(p.roughness)),
      mirror(alpha),
      mirror_loss(mirror.mean_loss()),
      ior(limited_ior(p)) {
  const double transmission = limited(p.transmission, 0, 1), metallic = limited(p.metallic, 0, 1);
  outside = front || thin || transmission == 0;
  metal = metallic, opaque = (1 - metallic) * (1 - transmission), glass = (1 - metallic) * transmission;
  if (opaque > 0) {
    const double specular = limited(p.specular, 0, 1);
    const double r =
        std::min(std::abs(ior - 1) / (ior + 1) * std::sqrt(2 * specular), (kMostIor - 1) / (kMostIor + 1));
    opaque_eta = (1 + r) / (1 - r), opaque_head_on = r * r;
    opaque_albedo = ReflectedAlbedo(opaque_eta, alpha);
  }
}

}  // namespace oktett
