/// \file The light that facets send to other facets, against random walks between facets (Heitz 2016) and the
/// formulas of Kulla and Conty (2017).

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "render/bsdf/bsdf.h"
#include "render/bsdf/ggx_albedo.h"
#include "render/bsdf/optics.h"
#include "tests/render/bsdf_support.h"

namespace oktett::bsdf_again_test {
namespace {

constexpr float kRoughness = 0.9f;
constexpr double kAlpha = 0.81;

/// The mean of f(c) over diffuse light: the integral of 2 c f(c).
template <class F>
double diffuse_mean(F&& f, int steps = 2000) {
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double c = (i + 0.5) / steps;
    sum += 2 * c * f(c) / steps;
  }
  return sum;
}

/// What facets that reflect all light send from `wi` to `wo` in one bounce, times the cosine.
double once(const Vec3f& wo, const Vec3f& wi, double alpha = kAlpha) {
  const Vec3d h = normalize(Vec3d(wo) + Vec3d(wi));
  return walter_density(h.z, alpha) / (1 + lambda(wo.z, alpha) + lambda(wi.z, alpha)) / (4 * wo.z);
}

PrincipledParameters metal(const Color& color, float roughness = kRoughness) {
  PrincipledParameters p;
  p.metallic = 1, p.roughness = roughness, p.base_color = color;
  return p;
}

Color value(const PrincipledParameters& p, const Vec3f& wo, const Vec3f& wi) {
  return principled_bsdf(p, wo, true).evaluate(wi).value;
}

/// What white facets give back of the light that a bounce loses, times the cosine.
double again(const Vec3f& wo, const Vec3f& wi) {
  return double{value(metal({1, 1, 1}), wo, wi).x} - once(wo, wi);
}

/// The mean loss of a bounce.
double mean_loss() {
  return diffuse_mean(
      [](double mu) {
        const Vec3f wo = direction_at(mu, 0);
        constexpr int kSteps = 60;
        double sum = 0;
        for (int i = 0; i < kSteps; ++i)
          for (int j = 0; j < kSteps; ++j)
            sum += 2 * std::numbers::pi / (kSteps * kSteps) *
                   once(wo, direction_at((i + 0.5) / kSteps, (j + 0.5) / kSteps * std::numbers::pi));
        return 1 - sum;
      },
      100);
}

/// A walk of light between the facets of a random surface whose heights are evenly distributed in [-1, 1].
class FacetWalk {
 public:
  explicit FacetWalk(double alpha) : alpha_(alpha) {}

  /// Where light that comes from `from` leaves the surface. Nothing if it has met less than two facets.
  std::optional<Vec3d> again(const Vec3d& from) {
    Vec3d w = -from;
    double below = 1;  // the fraction of the surface below the light
    for (int met = 0;; ++met) {
      // The chance to rise to a height without meeting a facet is (below / below there)^Lambda.
      const double u = 1 - uniform();
      if (w.z > 0 && u <= std::pow(below, shadows(w))) return met >= 2 ? std::optional(w) : std::nullopt;
      below = std::min(1.0, below * std::pow(u, -1 / shadows(w)));
      const Vec3d m = facet_towards(-w);
      w = normalize(w - m * (2 * dot(w, m)));
    }
  }

 private:
  double uniform() { return std::uniform_real_distribution<double>()(generator_); }
  /// Smith's Lambda, which downwards is -1 - Lambda(-w).
  double shadows(const Vec3d& w) const {
    const double l = lambda(std::abs(w.z), alpha_);
    return w.z > 0 ? l : -1 - l;
  }
  /// A facet by the area that it shows to `w`, which may lie below the horizon. GGX facets are those of a
  /// half sphere that has been stretched by 1 / alpha along z.
  Vec3d facet_towards(const Vec3d& w) {
    const Vec3d round = normalize(Vec3d{alpha_ * w.x, alpha_ * w.y, w.z});
    for (;;) {
      const double z = uniform(), size = std::sqrt(1 - z * z), turn = 2 * std::numbers::pi * uniform();
      const Vec3d m{size * std::cos(turn), size * std::sin(turn), z};
      if (uniform() < dot(round, m)) return normalize(Vec3d{alpha_ * m.x, alpha_ * m.y, m.z});
    }
  }

  double alpha_;
  std::mt19937_64 generator_{7};
};

/// Parts of the half sphere: bands of equal height, each in parts of equal azimuth, both sides together.
constexpr int kBands = 8, kTurns = 8;
using Parts = std::array<double, kBands * kTurns>;

Parts parts_of_walks(double mu, double alpha) {
  constexpr int kWalks = 200000;
  FacetWalk walk(alpha);
  Parts parts{};
  for (int i = 0; i < kWalks; ++i)
    if (const auto w = walk.again({std::sqrt(1 - mu * mu), 0, mu})) {
      const int band = std::min(kBands - 1, static_cast<int>(w->z * kBands));
      const double turn = std::abs(std::atan2(w->y, w->x)) / std::numbers::pi;
      parts[band * kTurns + std::min(kTurns - 1, static_cast<int>(turn * kTurns))] += 1.0 / kWalks;
    }
  return parts;
}

Parts parts_of_lobe(double mu, float roughness) {
  const double alpha = double{roughness} * roughness;
  const Vec3f wo = direction_at(mu, 0);
  const Bsdf bsdf = principled_bsdf(metal({1, 1, 1}, roughness), wo, true);
  constexpr int kSteps = 24;
  Parts parts{};
  for (int i = 0; i < kBands * kSteps; ++i)
    for (int j = 0; j < kTurns * kSteps; ++j) {
      const Vec3f wi =
          direction_at((i + 0.5) / (kBands * kSteps), (j + 0.5) / (kTurns * kSteps) * std::numbers::pi);
      parts[i / kSteps * kTurns + j / kSteps] += (double{bsdf.evaluate(wi).value.x} - once(wo, wi, alpha)) *
                                                 2 * std::numbers::pi / (kBands * kTurns * kSteps * kSteps);
    }
  return parts;
}

TEST(BsdfAgain, LeavesMetalWhereWalksBetweenFacetsLeaveIt) {
  struct Case {
    float roughness;
    double most;  // of this light in a wrong part; with lobes of diffuse shape 0.47, 0.27, 0.07 and 0.05
  };
  for (const auto& [roughness, most] : {Case{0.35f, 0.17}, {0.5f, 0.11}, {0.7f, 0.03}, {0.9f, 0.03}})
    for (const double mu : {0.3, 0.6, 0.95}) {
      const Parts truth = parts_of_walks(mu, double{roughness} * roughness);
      const Parts found = parts_of_lobe(mu, roughness);
      double loss = 0, sum = 0, apart = 0;
      for (std::size_t i = 0; i < truth.size(); ++i)
        loss += truth[i], sum += found[i], apart += std::abs(truth[i] - found[i]) / 2;
      EXPECT_NEAR(sum, loss, 0.004) << roughness << " " << mu;
      EXPECT_LT(apart, most * loss) << roughness << " " << mu;
    }
}

TEST(BsdfAgain, MetalColoursLightAtEveryBounce) {
  const double loss = mean_loss();
  EXPECT_GT(loss, 0.05);
  const auto expect_colour = [&](const PrincipledParameters& p, auto&& fresnel_of) {
    const double f = diffuse_mean(fresnel_of), expected = f * f * (1 - loss) / (1 - f * loss);
    for (const double mu : {0.3, 0.7, 0.95}) {
      const Vec3f wo = direction_at(mu, 1), wi = direction_at(0.6, 4);
      const double c = dot(Vec3d(wo), normalize(Vec3d(wo) + Vec3d(wi)));
      const double got = double{value(p, wo, wi).x} - once(wo, wi) * fresnel_of(c);
      EXPECT_NEAR(got / again(wo, wi), expected, 0.01 * expected) << mu;
    }
  };
  // Schlick's interpolation from the colour to white.
  for (const float color : {0.2f, 0.5f, 0.8f})
    expect_colour(metal({color, color, color}),
                  [=](double c) { return color + (1 - color) * std::pow(1 - c, 5); });
  PrincipledParameters gold = metal({1, 1, 1});
  gold.conductor.emplace();
  gold.conductor->eta = {0.2f, 0.2f, 0.2f}, gold.conductor->k = {3, 3, 3};
  expect_colour(gold, [](double c) { return conductor_fresnel(c, 0.2f, 3); });
}

// A wall reflects F = f + t^2 f / (1 - f^2) of diffuse light and passes t^2 / (1 - f^2), t = 1 - f.
TEST(BsdfAgain, ThinGlassSplitsItAsAPlateDoes) {
  for (const float ior : {1.2f, 1.5f, 2.0f}) {
    PrincipledParameters p;
    p.base_color = {1, 1, 1}, p.transmission = 1, p.thin = true, p.roughness = kRoughness, p.ior = ior;
    const double f = diffuse_mean([=](double c) { return fresnel(c, ior); });
    const double passed = (1 - f) * (1 - f) / (1 - f * f);
    const Vec3f wo = direction_at(0.6, 1), wi = direction_at(0.8, 4);
    const double c = dot(Vec3d(wo), normalize(Vec3d(wo) + Vec3d(wi))), one = fresnel(c, ior);
    const double plate = 2 * one / (1 + one);
    const double below = double{value(p, wo, {wi.x, wi.y, -wi.z}).x} - (1 - plate) * once(wo, wi);
    const double above = double{value(p, wo, wi).x} - plate * once(wo, wi);
    EXPECT_NEAR(below / (above + below), passed, 0.01) << ior;
  }
}

TEST(BsdfAgain, MeanFresnelIsTheIntegral) {
  EXPECT_EQ(mean_fresnel(1), 0);
  for (const double eta : {1.0002, 1.002, 1.05, 1.2, 1.5, 2.0, 2.4, 4.0}) {
    const double truth = diffuse_mean([=](double c) { return fresnel(c, eta); });
    EXPECT_NEAR(mean_fresnel(eta), truth, 1e-3 * truth) << eta;
  }
}

}  // namespace
}  // namespace oktett::bsdf_again_test
