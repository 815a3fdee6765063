#include <gtest/gtest.h>

#include "render/bsdf/bsdf.h"
#include "tests/render/bsdf_support.h"

namespace oktett::bsdf_furnace_test {
namespace {

/// What a surface sends to a viewer at the cosine `mu` in white light from all sides, by integration of its
/// values alone; of a surface that only mirrors and refracts, by the weights of samples.
double furnace(const PrincipledParameters& p, double mu, bool front) {
  const Vec3f wo = direction_at(mu, 0.3);
  const Bsdf bsdf = principled_bsdf(p, wo, front);
  if (bsdf.only_delta()) {
    constexpr int kSamples = 1000;
    double sum = 0;
    for (int i = 0; i < kSamples; ++i) {
      const auto sample = bsdf.sample((i + 0.5f) / kSamples, {});
      if (sample) sum += double{sample->weight.x} / kSamples;
    }
    return sum;
  }
  const double eta = p.thin ? 1 : front ? p.ior : 1 / p.ior;
  const PolarSquare mirrored({-wo.x, -wo.y, wo.z});
  const PolarSquare refracted(refracted_by_facets(Vec3d(wo), p.roughness, eta));
  const auto half = [&](const PolarSquare& square) {
    const auto value = [&](double s, double t) {
      return bsdf.evaluate(Vec3f(square.direction(s, t))).value.x * square.density(s, t);
    };
    double sum = 0;
    for (int i = 0; i < 16; ++i)
      for (int j = 0; j < 8; ++j)
        sum += integral(value, i / 16.0, (i + 1) / 16.0, j / 8.0, (j + 1) / 8.0, 3e-6, 6);
    return sum;
  };
  return half(mirrored) + (p.transmission > 0 ? half(refracted) : 0);
}

/// The cosine of 89.5 degrees.
constexpr double kGrazing = 0.0087265;

/// The least and most over roughnesses and directions.
void expect_white(const PrincipledParameters& material, bool front = true, double least = 0.99) {
  PrincipledParameters p = material;
  p.base_color = {1, 1, 1};
  for (const float roughness : {0.032f, 0.1f, 0.15f, 0.2f, 0.3f, 0.37f, 0.45f, 0.6f, 0.8f, 1.0f})
    for (const double mu : {kGrazing, 0.01, 0.1, 0.2, 0.45, 0.7, 0.85, 0.93, 1.0}) {
      p.roughness = roughness;
      const double sum = furnace(p, mu, front);
      EXPECT_GE(sum, least) << "roughness " << roughness << " cosine " << mu;
      EXPECT_LE(sum, 1.001) << "roughness " << roughness << " cosine " << mu;
    }
}

TEST(BsdfFurnace, MetalIsWhiteAtEveryRoughness) {
  PrincipledParameters p;
  p.metallic = 1;
  expect_white(p);
}

TEST(BsdfFurnace, OpaqueDielectricIsWhiteAtEveryRoughness) {
  PrincipledParameters p;
  for (const float ior : {0.6f, 1.0f, 1.005f, 1.02f, 1.1f, 1.5f, 2.4f}) {
    SCOPED_TRACE(ior);
    p.ior = ior;
    expect_white(p);
  }
}

// furnace() adds up red light. Of a channel that the interface reflects less, some is lost.
TEST(BsdfFurnace, ColouredReflectionsTakeNoMoreThanTheyGive) {
  PrincipledParameters p;
  for (const float ior : {1.1f, 1.5f, 4.0f})
    for (const float color : {0.0f, 0.5f, 4.0f, 30.0f}) {
      SCOPED_TRACE(testing::Message() << ior << ' ' << color);
      p.ior = ior, p.specular_color = {color, 0, 0}, p.specular_weight = 1;
      expect_white(p);
    }
  p.specular_color = {0.25f, 1, 0}, p.ior = 1.5f;
  expect_white(p, true, 0.6);
  p.specular_color = {1, 1, 1}, p.specular_weight = 0.3f;
  expect_white(p);
}

class GlassFurnace : public testing::TestWithParam<float> {};

TEST_P(GlassFurnace, IsWhiteAtEveryRoughnessFromBothSides) {
  PrincipledParameters p;
  p.transmission = 1, p.ior = GetParam();
  for (const bool front : {true, false}) {
    SCOPED_TRACE(front);
    expect_white(p, front);
  }
}

// Also of the index 1 and close to it, where the albedo of facets changes fast with the index.
INSTANTIATE_TEST_SUITE_P(Bsdf, GlassFurnace,
                         testing::Values(0.5f, 0.7f, 0.9f, 0.99f, 0.995f, 0.999f, 1.0f, 1.001f, 1.005f, 1.01f,
                                         1.02f, 1.03f, 1.05f, 1.1f, 1.33f, 1.5f, 1.8f, 2.4f));

TEST(BsdfFurnace, ThinGlassIsWhiteAtEveryRoughness) {
  PrincipledParameters p;
  p.transmission = 1;
  p.thin = true;
  for (const float ior : {0.9f, 1.0f, 1.005f, 1.5f}) {
    SCOPED_TRACE(ior);
    p.ior = ior;
    expect_white(p);
  }
}

TEST(BsdfFurnace, LayersTakeNoMoreThanTheyGive) {
  PrincipledParameters p;
  p.coat = 1, p.coat_roughness = 0.3f, p.sheen = 1, p.metallic = 0.5f, p.transmission = 0.5f;
  expect_white(p);
  p = {};
  p.coat = 0.7f, p.coat_roughness = 0.1f, p.sheen = 0.5f, p.sheen_roughness = 0.8f;
  expect_white(p);
  p = {};
  p.coat = 1, p.coat_roughness = 0.6f;
  for (const float ior : {1.003f, 1.015f, 1.04f}) {
    SCOPED_TRACE(ior);
    p.coat_ior = ior;
    expect_white(p);
  }
}

}  // namespace
}  // namespace oktett::bsdf_furnace_test
