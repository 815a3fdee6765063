/// \file The colour and weight of what the opaque dielectric reflects (KHR_materials_specular).

#include <gtest/gtest.h>

#include <cmath>

#include "render/bsdf/bsdf.h"
#include "render/bsdf/optics.h"
#include "tests/render/bsdf_support.h"

namespace oktett::bsdf_specular_test {
namespace {

/// What a smooth black surface mirrors: the coefficients of its samples, each over its probability, summed.
Color mirrored(PrincipledParameters p, double mu) {
  p.base_color = {0, 0, 0}, p.roughness = 0;
  const Bsdf bsdf = principled_bsdf(p, direction_at(mu, 0.4), true);
  constexpr int kSamples = 4000;
  Vec3d sum;
  for (int i = 0; i < kSamples; ++i)
    if (const auto sample = bsdf.sample((i + 0.5f) / kSamples, {0.3, 0.6}); sample && sample->delta)
      sum += Vec3d(sample->weight) / kSamples;
  return Color(sum);
}

/// F0 = min(((ior - 1) / (ior + 1))^2 color, 1) weight, F90 = weight.
TEST(BsdfSpecular, ReflectanceHeadOnAndGrazingIsThatOfTheExtension) {
  for (const float ior : {1.2f, 1.5f, 2.0f, 4.0f})
    for (const Color color : {Color{1, 1, 1}, Color{0.5f, 0, 1}, Color{3, 20, 1000}})
      for (const float weight : {1.0f, 0.4f, 0.0f}) {
        PrincipledParameters p;
        p.ior = ior, p.specular_color = color, p.specular_weight = weight;
        const double r = (double{ior} - 1) / (double{ior} + 1);
        const Color head_on = mirrored(p, 1), grazing = mirrored(p, 1e-5);
        for (int k = 0; k < 3; ++k) {
          EXPECT_NEAR(head_on[k], std::min(r * r * double{color[k]}, 1.0) * double{weight}, 1e-6);
          EXPECT_NEAR(grazing[k], weight, 2e-4);
        }
      }
}

// In between it grows as Fresnel's: by the same part of what is missing to F90.
TEST(BsdfSpecular, ReflectanceGrowsAsFresnels) {
  PrincipledParameters p;
  p.specular_color = {2, 0.5f, 0}, p.specular_weight = 0.8f;
  for (double mu = 0.05; mu < 1; mu += 0.05) {
    const double grown = (fresnel(mu, 1.5) - 0.04) / 0.96;
    const Color got = mirrored(p, mu);
    for (int k = 0; k < 3; ++k) {
      const double head_on = 0.04 * double{p.specular_color[k]};
      EXPECT_NEAR(got[k], 0.8 * (head_on + (1 - head_on) * grown), 1e-5) << mu;
    }
  }
}

TEST(BsdfSpecular, RoughSurfacesHaveItInEachFacet) {
  for (std::uint64_t n = 0; n < 200; ++n) {
    const std::uint64_t key = mix_bits(n);
    const auto direction = [&](std::uint32_t i) {
      return direction_at(0.05 + 0.95 * random_float(key, i, 0), 6.28 * random_float(key, i, 1));
    };
    const Vec3f wo = direction(1), wi = direction(2);
    PrincipledParameters p;
    p.base_color = {0, 0, 0}, p.specular_color = {5, 0.3f, 1}, p.specular_weight = 0.6f;
    p.roughness = 0.2f + 0.8f * random_float(key, 3, 0);
    const double alpha = double{p.roughness} * double{p.roughness};
    const Vec3d h = normalize(Vec3d(wo) + Vec3d(wi));
    const double shown =
        walter_density(h.z, alpha) / (1 + lambda(wo.z, alpha) + lambda(wi.z, alpha)) / (4 * double{wo.z});
    const double grown = (fresnel(dot(Vec3d(wo), h), 1.5) - 0.04) / 0.96;
    const Color got = principled_bsdf(p, wo, true).evaluate(wi).value;
    for (int k = 0; k < 3; ++k) {
      const double head_on = 0.04 * double{p.specular_color[k]};
      const double expected = 0.6 * (head_on + (1 - head_on) * grown) * shown;
      EXPECT_NEAR(got[k], expected, 1e-3 * expected) << n;
    }
  }
}

// What the brightest channel of the interface leaves passes, so none turns into its complement.
TEST(BsdfSpecular, ColourTakesAllChannelsOfDiffuseLightAlike) {
  PrincipledParameters p;
  p.base_color = {1, 1, 1}, p.roughness = 0, p.specular_color = {0, 8, 2};
  const Vec3f wi = direction_at(0.7, 2);
  const Color got = principled_bsdf(p, direction_at(0.9, 0.4), true).evaluate(wi).value;
  EXPECT_GT(got.y, 0.1f);
  EXPECT_EQ(got.x, got.y);
  EXPECT_EQ(got.z, got.y);
}

TEST(BsdfSpecular, AnInterfaceThatReflectsAllHidesDiffuseLight) {
  PrincipledParameters p;
  p.base_color = {1, 1, 1}, p.specular_color = {25, 25, 25}, p.roughness = 0;
  const Bsdf bsdf = principled_bsdf(p, direction_at(0.6, 0.4), true);
  EXPECT_EQ(bsdf.evaluate(direction_at(0.7, 2)).value, (Color{0, 0, 0}));
  EXPECT_NEAR(mirrored(p, 0.6).x, 1, 1e-6);
}

}  // namespace
}  // namespace oktett::bsdf_specular_test
