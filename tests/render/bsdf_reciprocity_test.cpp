/// \file What is the same if light and viewer are exchanged, and by how much the rest differs.

#include <gtest/gtest.h>

#include "render/bsdf/bsdf.h"
#include "render/bsdf/ggx_albedo.h"
#include "tests/render/bsdf_support.h"

namespace oktett::bsdf_reciprocity_test {
namespace {

using Lane = Simd<double, 1, ScalarIsa>;

/// A direction whose cosine is at least `least`.
Vec3f random_above(std::uint64_t key, double least = 0.02) {
  return direction_at(least + (1 - least) * random_float(key, 1, 0),
                      2 * std::numbers::pi * random_float(key, 1, 1));
}
Vec3f flipped(const Vec3f& w) { return {w.x, w.y, -w.z}; }

void expect_close(const Color& a, const Color& b, double relative, double absolute = 0) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], relative * std::abs(b[k]) + absolute);
}

/// What a material sends to a viewer at `wo` of light from `wi`, without the cosine.
double scattered(const PrincipledParameters& p, const Vec3f& wo, const Vec3f& wi) {
  return double{principled_bsdf(p, wo, true).evaluate(wi).value.x} / static_cast<double>(wi.z);
}

/// The largest difference between both ways, relative to the greater, of directions up to 72 degrees.
double asymmetry(const PrincipledParameters& p) {
  double most = 0;
  for (std::uint64_t n = 0; n < 1000; ++n) {
    const Vec3f a = random_above(mix_bits(2 * n), 0.3), b = random_above(mix_bits(2 * n + 1), 0.3);
    const double there = scattered(p, a, b), back = scattered(p, b, a);
    most = std::max(most, std::abs(there - back) / std::max(there, back));
  }
  return most;
}

TEST(BsdfReciprocity, BaseIsReciprocal) {
  constexpr float kIor[] = {0.7f, 0.99f, 0.999f, 1.001f, 1.005f, 1.03f, 1.33f, 1.5f, 2.4f};
  for (std::uint64_t n = 0; n < 2000; ++n) {
    const std::uint64_t key = mix_bits(n + 5000);
    const Vec3f a = random_above(key), b = random_above(key + 1);
    PrincipledParameters p;
    p.roughness = 0.04f + 0.96f * random_float(key, 2, 0);
    p.metallic = random_float(key, 2, 1) < 0.3f ? 0.4f : 0;
    p.transmission = random_float(key, 2, 2);
    p.ior = kIor[n % std::size(kIor)];
    p.thin = n % 5 == 0;
    if (n % 7 == 0) p.conductor.emplace();
    if (n % 3 == 0) p.specular_color = {0.2f, 3, 9}, p.specular_weight = 0.7f;
    const bool front = n % 2 == 0;
    const Color there = principled_bsdf(p, a, front).evaluate(b).value / b.z;
    const Color back = principled_bsdf(p, b, front).evaluate(a).value / a.z;
    expect_close(there, back, 2e-3, 1e-6);
    // Through the surface. f' n^2 is symmetric, n the index on the viewer's side: radiance leaves eta^2 out.
    const double eta = p.thin ? 1 : front ? p.ior : 1 / p.ior;
    const Color down = principled_bsdf(p, a, front).evaluate(flipped(b)).value / b.z;
    const Color up = principled_bsdf(p, b, p.thin ? front : !front).evaluate(flipped(a)).value / a.z;
    expect_close(down, up * static_cast<float>(eta * eta), 1e-2, 1e-5);
  }
}

PrincipledParameters coated(float roughness) {
  PrincipledParameters p;
  p.coat = 1, p.coat_roughness = roughness;
  return p;
}

// A coat is; what lies below it is but for the part that the coat leaves for the viewer's direction.
TEST(BsdfReciprocity, CoatTakesByTheDirectionOfTheViewer) {
  for (const float roughness : {0.0f, 0.1f, 0.3f, 0.7f})
    for (std::uint64_t n = 0; n < 300; ++n) {
      const Vec3f a = random_above(mix_bits(n)), b = random_above(mix_bits(n + 1000));
      PrincipledParameters p = coated(roughness), black = p;
      black.base_color = {0, 0, 0}, black.specular = 0;
      p.metallic = n % 2 == 0 ? 0.5f : 0, p.roughness = 0.4f;
      const double coat = scattered(black, a, b), coat_back = scattered(black, b, a);
      EXPECT_NEAR(coat, coat_back, 2e-3 * coat + 1e-6);
      const ReflectedAlbedo albedo(1.5, roughness == 0 ? 0 : double{roughness} * double{roughness});
      const double there = (scattered(p, a, b) - coat) / (1 - only_lane(albedo(Lane(a.z))));
      const double back = (scattered(p, b, a) - coat_back) / (1 - only_lane(albedo(Lane(b.z))));
      EXPECT_NEAR(there, back, 5e-3 * back + 2e-5 * coat + 1e-5);
    }
}

// So the two ways differ by the albedos of the coat, which is 0.04 head-on and 0.21 at 72 degrees if it is
// smooth.
TEST(BsdfReciprocity, CoatsAndSheenAreNearlyReciprocalAwayFromGrazing) {
  for (const float roughness : {0.0f, 0.3f, 1.0f}) EXPECT_LT(asymmetry(coated(roughness)), 0.18) << roughness;
  for (const float roughness : {0.1f, 0.3f, 0.5f, 0.7f, 1.0f}) {
    PrincipledParameters p;
    p.sheen = 1, p.sheen_roughness = roughness;
    EXPECT_LT(asymmetry(p), 0.36) << roughness;
  }
}

// Phong's highlight is the model of lamps, without the cosine of the light: it is symmetric as it stands.
TEST(BsdfReciprocity, PhongsHighlightIsSymmetricTogetherWithTheCosine) {
  PhongParameters lambert, highlight;
  lambert.diffuse = 0.8f, lambert.specular = 0;
  highlight.diffuse = 0, highlight.specular = 0.7f, highlight.phong = 12;
  for (std::uint64_t n = 0; n < 300; ++n) {
    const Vec3f a = random_above(mix_bits(n)), b = random_above(mix_bits(n + 1000));
    const auto value = [](const PhongParameters& p, const Vec3f& wo, const Vec3f& wi) {
      return phong_bsdf(p, wo, true).evaluate(wi).value;
    };
    expect_close(value(lambert, a, b) / b.z, value(lambert, b, a) / a.z, 1e-5);
    expect_close(value(highlight, a, b), value(highlight, b, a), 1e-4, 1e-7);
  }
}

}  // namespace
}  // namespace oktett::bsdf_reciprocity_test
