/// \file The light that facets send to other facets, against the formulas of Kulla and Conty (2017).

#include <gtest/gtest.h>

#include <cmath>

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
double diffuse_mean(F&& f) {
  constexpr int kSteps = 2000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double c = (i + 0.5) / kSteps;
    sum += 2 * c * f(c) / kSteps;
  }
  return sum;
}

/// What facets that reflect all light send from `wi` to `wo` in one bounce, times the cosine.
double once(const Vec3f& wo, const Vec3f& wi) {
  const Vec3d h = normalize(Vec3d(wo) + Vec3d(wi));
  return walter_density(h.z, kAlpha) / (1 + lambda(wo.z, kAlpha) + lambda(wi.z, kAlpha)) / (4 * wo.z);
}

PrincipledParameters metal(const Color& color) {
  PrincipledParameters p;
  p.metallic = 1, p.roughness = kRoughness, p.base_color = color;
  return p;
}

Color value(const PrincipledParameters& p, const Vec3f& wo, const Vec3f& wi) {
  return principled_bsdf(p, wo, true).evaluate(wi).value;
}

/// What white facets give back of the light that a bounce loses, times the cosine.
double again(const Vec3f& wo, const Vec3f& wi) {
  return double{value(metal({1, 1, 1}), wo, wi).x} - once(wo, wi);
}

/// The mean loss of a bounce, by what white facets give back.
double mean_loss() {
  return diffuse_mean([](double mu) {
    const Vec3f wo = direction_at(mu, 0.5);
    constexpr int kSteps = 200;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
      sum += 2 * std::numbers::pi * again(wo, direction_at((i + 0.5) / kSteps, 3)) / kSteps;
    return sum;
  });
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
