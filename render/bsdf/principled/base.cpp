#include "render/bsdf/principled/base.h"

#include <algorithm>
#include <cmath>

namespace oktett {

double facet_width(double roughness) {
  const double rho = limited(roughness, 0, 1);
  return rho < kLeastRoughness ? 0 : rho * rho;
}

FacetWidths base_facets(const PrincipledParameters& p) {
  const double width = facet_width(p.roughness), anisotropy = limited(p.anisotropy, 0, 1);
  if (anisotropy == 0) return width;
  const double narrow = std::max(width, kLeastRoughness * kLeastRoughness);
  return {narrow + (1 - narrow) * anisotropy * anisotropy, narrow};
}

static double limited_ior(const PrincipledParameters& p) { return limited(p.ior, 1 / kMostIor, kMostIor); }

bool is_smooth_glass(const PrincipledParameters& p) {
  const double ior = limited_ior(p);
  // By the greater of the two indices, so that both sides agree.
  return base_facets(p).x == 0 || (!p.thin && std::max(ior, 1 / ior) - 1 < kLeastIorDifference);
}

PrincipledBase::PrincipledBase(const PrincipledParameters& p, bool is_front)
    : base_color(limited(p.base_color, 0, 1)),
      tint(max_component(base_color)),
      front(is_front),
      thin(p.thin),
      facets(base_facets(p)),
      alpha(facets.stretched() ? std::sqrt((facets.x * facets.x + facets.y * facets.y) / 2) : facets.x),
      mirror(alpha),
      mirror_loss(mirror.mean_loss()),
      ior(limited_ior(p)) {
  const double transmission = limited(p.transmission, 0, 1), metallic = limited(p.metallic, 0, 1);
  outside = front || thin || transmission == 0;
  metal = metallic, opaque = (1 - metallic) * (1 - transmission), glass = (1 - metallic) * transmission;
  if (outside) film = limited(p.iridescence, 0, 1);
  if (opaque > 0) {
    const double specular = limited(p.specular, 0, 1);
    const double r =
        std::min(std::abs(ior - 1) / (ior + 1) * std::sqrt(2 * specular), (kMostIor - 1) / (kMostIor + 1));
    opaque_eta = (1 + r) / (1 - r), opaque_head_on = r * r;
    dielectric_ = ReflectedAlbedo(opaque_eta, alpha);
    opaque_loss = dielectric_.mean_loss();
    // That of stretched facets lies in between. The greatest is the one with which nothing is gained.
    if (facets.stretched())
      for (const double width : {facets.x, facets.y})
        opaque_loss = std::max(opaque_loss, ReflectedAlbedo(opaque_eta, width).mean_loss());
    set_specular(p);
    if (film > 0) set_film(p);
  }
}

void PrincipledBase::set_specular(const PrincipledParameters& p) {
  const double weight = specular_weight_ = limited(p.specular_weight, 0, 1), plain = opaque_head_on;
  if (weight == 1 && p.specular_color == Color{1, 1, 1}) return;
  has_specular_color_ = true;
  const auto line = [&](double color) -> SpecularLine {
    const double head_on = std::min(1.0, plain * color);
    return {weight * (1 - head_on) / (1 - plain), weight * (head_on - plain) / (1 - plain)};
  };
  const Vec3d color = limited(p.specular_color, 0, kMaxCoordinate);
  for (int k = 0; k < 3; ++k) specular_[k] = line(color[k]);
  most_ = line(max_component(color));
  opaque_head_on = most_.slope * plain + most_.rise;
  opaque_loss = 1 - most_.slope * (1 - opaque_loss) - most_.rise * (1 - mirror_loss);
}

ThinFilm film_on(const PrincipledParameters& p, const Vec3d& eta, const Vec3d& k) {
  return {limited(p.iridescence_ior, 1, kMostIor), limited(p.iridescence_thickness, 0, kMostFilm), eta, k};
}

void PrincipledBase::set_film(const PrincipledParameters& p) {
  using Single = Simd<double, 1, ScalarIsa>;
  const auto brightest = [&](double c) { return only_lane(brightest_fresnel(Single(c))); };
  const double plain = fresnel(1, opaque_eta), weight = specular_weight_;
  Vec3d eta;
  for (int k = 0; k < 3; ++k)
    eta[k] = weight > 0 ? ior_of_head_on((specular_[k].slope * plain + specular_[k].rise) / weight) : 1;
  opaque_film_ = film_on(p, eta, {});
  opaque_head_on = brightest(1);
  for (int i = 0; alpha > 0 && i < kFilmNodes; ++i)
    brightest_.push_back(static_cast<float>(brightest(static_cast<double>(i) / (kFilmNodes - 1))));
  // A film changes what facets reflect of diffuse light by no more than what a smooth surface does.
  const auto bare = [&](double c) {
    return std::max(0.0, most_.slope * fresnel(c, opaque_eta) + most_.rise);
  };
  double change = 0;
  constexpr int kPoints = 32;
  for (int i = 0; i < kPoints; ++i) {
    const double c = (i + 0.5) / kPoints;
    change += 2 * c * (bare(c) - brightest(c)) / kPoints;
  }
  opaque_loss = std::min(1.0, opaque_loss + (alpha > 0 ? std::max(change, 0.0) : change));
}

}  // namespace oktett
