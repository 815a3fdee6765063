#include "render/bsdf/bsdf.h"

#include <gtest/gtest.h>

#include <cfloat>

#include "render/bsdf/optics.h"
#include "render/bsdf/principled/sheen.h"
#include "tests/render/bsdf_support.h"

namespace oktett::bsdf_test {
namespace {

Vec3f random_above(std::uint64_t key) {
  return direction_at(0.02 + 0.98 * random_float(key, 1, 0), 2 * std::numbers::pi * random_float(key, 1, 1));
}
Vec3f flipped(const Vec3f& w) { return {w.x, w.y, -w.z}; }

void expect_close(const Color& a, const Color& b, double relative, double absolute = 0) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], relative * std::abs(b[k]) + absolute);
}

/// The mean weight over samples of all lobes.
Color mean_weight(const Bsdf& bsdf, int lobes = 1000, int directions = 16) {
  Vec3d sum;
  for (int i = 0; i < lobes; ++i)
    for (int j = 0; j < directions; ++j) {
      const auto s = bsdf.sample((i + 0.5f) / static_cast<float>(lobes),
                                 {random_float(9, i, 2 * j), random_float(9, i, 2 * j + 1)});
      if (s) sum += Vec3d(s->weight);
    }
  return Color(sum / (lobes * directions));
}

TEST(Bsdf, BlackDielectricIsTheMicrofacetFormula) {
  for (std::uint64_t n = 0; n < 300; ++n) {
    const std::uint64_t key = mix_bits(n);
    const Vec3f wo = random_above(key), wi = random_above(key + 1);
    PrincipledParameters p;
    p.base_color = {0, 0, 0};
    p.roughness = 0.1f + 0.9f * random_float(key, 2, 0);
    const double alpha = double{p.roughness} * p.roughness;
    const Vec3d h = normalize(Vec3d(wo) + Vec3d(wi));
    const double f = fresnel(dot(Vec3d(wo), h), 1.5);
    const double expected =
        f * walter_density(h.z, alpha) / (1 + lambda(wo.z, alpha) + lambda(wi.z, alpha)) / (4 * wo.z);
    expect_close(principled_bsdf(p, wo, true).evaluate(wi).value,
                 Color{1, 1, 1} * static_cast<float>(expected), 1e-3);
  }
}

// Walter 2007, equation 21, near the peak, where other lobes are weaker by far. Without the factor eta^2.
TEST(Bsdf, GlassTransmitsAsTheMicrofacetFormula) {
  for (const bool front : {true, false})
    for (const double mu : {0.8, 0.95, 1.0}) {
      PrincipledParameters p;
      p.base_color = {1, 1, 1}, p.transmission = 1, p.roughness = 0.25f;
      const double alpha = 0.0625, eta = front ? 1.5 : 1 / 1.5;
      const Vec3f wo = direction_at(mu, 1), wi = *refract(-wo, {0, 0, 1}, static_cast<float>(eta));
      // The half vector is the normal.
      const double c = wo.z, d = -wi.z;
      const double lambdas = lambda(c, alpha) + lambda(d, alpha);
      const double f = c * d / (c * d) * eta * eta * (1 - fresnel(c, eta)) * walter_density(1, alpha) /
                       (1 + lambdas) / ((c - eta * d) * (c - eta * d));
      expect_close(principled_bsdf(p, wo, front).evaluate(wi).value,
                   Color{1, 1, 1} * static_cast<float>(f * d), 2e-3);
    }
}

TEST(Bsdf, SmoothGlassIsDeltaAndKeepsAllLight) {
  PrincipledParameters p;
  p.base_color = {1, 1, 1}, p.transmission = 1, p.roughness = 0;
  for (const bool thin : {false, true})
    for (const bool front : {true, false})
      for (const float ior : {0.7f, 1.0f, 1.5f})
        for (const double mu : {0.05, 0.6, 0.8, 1.0}) {
          p.thin = thin, p.ior = ior;
          const Vec3f wo = direction_at(mu, 2);
          const Bsdf bsdf = principled_bsdf(p, wo, front);
          EXPECT_TRUE(bsdf.only_delta());
          EXPECT_EQ(bsdf.evaluate(flipped(wo)).pdf, 0);
          const float eta = front ? ior : 1 / ior;
          for (const float lobe : {0.0f, 0.01f, 0.5f, 0.99f}) {
            const auto s = bsdf.sample(lobe, {0.3, 0.6});
            ASSERT_TRUE(s);
            EXPECT_TRUE(s->delta);
            EXPECT_EQ(s->pdf, 0);
            expect_close(s->weight, {1, 1, 1}, 1e-5);
            const Vec3f mirrored{-wo.x, -wo.y, wo.z};
            const Vec3f through = thin ? -wo : refract(-wo, {0, 0, 1}, eta).value_or(mirrored);
            EXPECT_LT(length(s->direction - (s->transmitted ? through : mirrored)), 1e-5f);
          }
          const double f = fresnel(mu, thin ? ior : eta), reflectance = thin ? 2 * f / (1 + f) : f;
          int reflected = 0;
          for (int i = 0; i < 1000; ++i) reflected += !bsdf.sample((i + 0.5f) / 1000, {})->transmitted;
          EXPECT_NEAR(reflected, 1000 * reflectance, 1.01);
        }
}

TEST(Bsdf, IndexOneDoesNotReflect) {
  PrincipledParameters p;
  p.base_color = {1, 1, 1}, p.transmission = 1, p.ior = 1, p.roughness = 0.7f;
  const Vec3f wo = direction_at(0.4, 1);
  const auto s = principled_bsdf(p, wo, true).sample(0.5f, {0.2, 0.4});
  ASSERT_TRUE(s && s->delta && s->transmitted);
  EXPECT_LT(length(s->direction + wo), 1e-6f);
  p.transmission = 0;
  const Vec3f wi = direction_at(0.7, 3);
  expect_close(principled_bsdf(p, wo, true).evaluate(wi).value,
               Color{1, 1, 1} * static_cast<float>(wi.z / std::numbers::pi), 5e-3);
}

TEST(Bsdf, SmoothMetalIsAMirror) {
  PrincipledParameters p;
  p.metallic = 1, p.roughness = 0, p.base_color = {0.9f, 0.5f, 0.1f};
  const auto s = principled_bsdf(p, direction_at(1, 0), true).sample(0.4f, {});
  ASSERT_TRUE(s && s->delta && !s->transmitted);
  expect_close(s->weight, p.base_color, 1e-6);
  p.conductor = Conductor{{0.2f, 0.9f, 1.1f}, {3.9f, 2.5f, 0}};
  const auto c = principled_bsdf(p, direction_at(1, 0), true).sample(0.4f, {});
  ASSERT_TRUE(c);
  for (int k = 0; k < 3; ++k) {
    const double n = p.conductor->eta[k], absorption = p.conductor->k[k];
    const double expected =
        ((n - 1) * (n - 1) + absorption * absorption) / ((n + 1) * (n + 1) + absorption * absorption);
    EXPECT_NEAR(c->weight[k], expected, 1e-6);
  }
  // Without absorption a conductor is a dielectric.
  for (double cosine = 0.01; cosine < 1; cosine += 0.01)
    for (const double eta : {0.6, 1.0, 1.5})
      EXPECT_NEAR(conductor_fresnel(cosine, eta, 0), fresnel(cosine, eta), 1e-6) << cosine << ' ' << eta;
}

TEST(Bsdf, SmoothCoatReflectsByFresnelAndLeavesTheRest) {
  PrincipledParameters p;
  p.base_color = {1, 1, 1}, p.specular = 0, p.coat = 1, p.coat_roughness = 0;
  for (const double mu : {0.1, 0.5, 1.0})
    expect_close(mean_weight(principled_bsdf(p, direction_at(mu, 1), true)), {1, 1, 1}, 4e-3);
}

TEST(Bsdf, SheenLobeKeepsWhatItTakes) {
  PrincipledParameters p;
  p.base_color = {0, 0, 0}, p.specular = 0, p.sheen = 1;
  double last = 0;
  for (const double mu : {1.0, 0.6, 0.3, 0.1}) {
    const float sheen = mean_weight(principled_bsdf(p, direction_at(mu, 1), true)).x;
    EXPECT_GE(sheen, last);
    EXPECT_LE(sheen, 1);
    last = sheen;
  }
  EXPECT_GT(last, 0.2);
}

// The albedo that the paper's fit gives, computed apart from its published coefficients.
TEST(Bsdf, SheenHasTheAlbedoOfItsFit) {
  const auto albedo = [](double mu, double roughness) {
    return SheenFibres(Vec3d{std::sqrt(1 - mu * mu), 0, mu}, roughness).albedo();
  };
  EXPECT_NEAR(albedo(0.1, 0.3), 0.439954, 1e-5);
  EXPECT_NEAR(albedo(0.5, 0.3), 0.020821, 1e-5);
  EXPECT_NEAR(albedo(0.3, 0.6), 0.390237, 1e-5);
  EXPECT_NEAR(albedo(0.8, 0.6), 0.094970, 1e-5);
  EXPECT_NEAR(albedo(0.2, 1.0), 0.643234, 1e-5);
  EXPECT_NEAR(albedo(0.9, 1.0), 0.364234, 1e-5);
}

TEST(BsdfPhong, IsTheModelOfLamps) {
  PhongParameters p;
  p.color = {0.5f, 0.25f, 1}, p.specular_color = {1, 0.5f, 0.25f};
  p.diffuse = 0.6f, p.specular = 0.8f;
  for (const float exponent : {0.0f, 3.0f, 20.5f}) {
    p.phong = exponent;
    for (std::uint64_t n = 0; n < 100; ++n) {
      const Vec3f wo = random_above(mix_bits(n)), wi = random_above(mix_bits(n + 1000));
      const double highlight = -wo.x * wi.x - wo.y * wi.y + wo.z * wi.z;
      const double shine = highlight > 0 ? std::pow(highlight, exponent) : 0;
      const Color expected =
          (p.color * (p.diffuse * wi.z) + p.specular_color * static_cast<float>(p.specular * shine)) /
          static_cast<float>(std::numbers::pi);
      expect_close(phong_bsdf(p, wo, true).evaluate(wi).value, expected, 1e-5, 1e-6);
      EXPECT_EQ(phong_bsdf(p, wo, true).evaluate(-wi).pdf, 0);
    }
  }
}

// Blinn's highlight by the angle between the normal and the halfway direction, and diffuse light that falls
// off by a power of the cosine.
TEST(BsdfPhong, HasBlinnsHighlightAndBrilliance) {
  PhongParameters p;
  p.color = {0.5f, 0.25f, 1}, p.specular_color = {1, 0.5f, 0.25f};
  p.diffuse = 0.6f, p.specular = 0;
  for (const float exponent : {0.5f, 3.0f, 20.5f}) {
    p.brilliance = exponent, p.specular_blinn = 0.8f, p.blinn = 2 * exponent;
    for (std::uint64_t n = 0; n < 100; ++n) {
      const Vec3f wo = random_above(mix_bits(n)), wi = random_above(mix_bits(n + 1000));
      const double angle = std::acos(normalize(Vec3d(wo) + Vec3d(wi)).z);
      const double shine = std::pow(std::cos(angle), 2 * exponent);
      const Color expected = (p.color * static_cast<float>(0.6 * std::pow(double{wi.z}, double{exponent})) +
                              p.specular_color * static_cast<float>(0.8 * shine)) /
                             static_cast<float>(std::numbers::pi);
      expect_close(phong_bsdf(p, wo, true).evaluate(wi).value, expected, 1e-5, 1e-6);
    }
  }
}

// By the integral of cos^n over the hemisphere, 2 pi / (n + 1).
TEST(BsdfPhong, BrillianceTakesItsPartOfTheLight) {
  PhongParameters p;
  p.color = {1, 1, 1}, p.diffuse = 0.6f;
  for (const float exponent : {0.0f, 0.5f, 4.0f}) {
    p.brilliance = exponent;
    const float part = 0.6f * 2 / (exponent + 1);
    expect_close(mean_weight(phong_bsdf(p, direction_at(0.6, 1), true), 4000, 1), Color{part, part, part},
                 1e-3);
  }
}

TEST(BsdfPhong, MirrorsMayHaveTheirOwnColour) {
  PhongParameters p;
  p.diffuse = 0, p.reflection = 0.5f, p.specular_color = {1, 0, 0}, p.mirror_color = Color{0, 1, 0.5f};
  expect_close(mean_weight(phong_bsdf(p, direction_at(0.6, 1), true), 100, 1), {0, 0.5f, 0.25f}, 1e-5);
}

TEST(BsdfPhong, MirrorAndGlassAreDelta) {
  PhongParameters p;
  p.diffuse = 0, p.reflection = 0.3f, p.transparency = 0.7f, p.color = {0.5f, 1, 1};
  const Vec3f wo = direction_at(0.6, 1);
  const Bsdf bsdf = phong_bsdf(p, wo, true);
  EXPECT_TRUE(bsdf.only_delta());
  const float f = static_cast<float>(fresnel(0.6, 1.5));
  expect_close(mean_weight(bsdf, 1000, 1), Color{1, 1, 1} * (0.3f + 0.7f * f) + p.color * (0.7f * (1 - f)),
               2e-3);
  // Beyond the critical angle all is reflected.
  const auto inside = phong_bsdf(p, direction_at(0.3, 0), false).sample(0.999f, {});
  ASSERT_TRUE(inside && !inside->transmitted);
  expect_close(inside->weight, {1, 1, 1}, 1e-5);
}

float adversarial(std::uint64_t key, std::uint32_t dimension) {
  constexpr float kValues[] = {
      0,     -1,      1,       0.5f,         1e-30f,       1e30f, -1e30f, FLT_MAX, -FLT_MAX, FLT_TRUE_MIN,
      1e-3f, 0.0316f, 0.0317f, 1 - 0x1p-24f, 1 + 0x1p-23f, 1.5f,  0.999f, 3.99f,   1e-7f,    1e4f};
  return kValues[random_bits(key, 7, dimension) % std::size(kValues)];
}
Color adversarial_color(std::uint64_t key, std::uint32_t d) {
  return {adversarial(key, d), adversarial(key, d + 1), adversarial(key, d + 2)};
}

PrincipledParameters adversarial_principled(std::uint64_t key) {
  PrincipledParameters p;
  p.base_color = adversarial_color(key, 0), p.sheen_color = adversarial_color(key, 3);
  float* const scalars[] = {&p.metallic, &p.roughness,      &p.specular, &p.ior,   &p.transmission,
                            &p.coat,     &p.coat_roughness, &p.coat_ior, &p.sheen, &p.sheen_roughness};
  std::uint32_t d = 10;
  for (float* s : scalars) *s = adversarial(key, d++);
  p.specular_color = adversarial_color(key, 38), p.specular_weight = adversarial(key, 41);
  if (random_bits(key, 7, 46) % 2 == 0) {
    p.anisotropy = adversarial(key, 47), p.iridescence = adversarial(key, 48);
    p.iridescence_ior = adversarial(key, 49), p.iridescence_thickness = adversarial(key, 50);
  }
  if (random_bits(key, 7, 42) % 3 == 0) p.coat_normal = adversarial_color(key, 43);
  p.thin = random_bits(key, 7, 30) % 3 == 0;
  if (random_bits(key, 7, 31) % 3 == 0)
    p.conductor = Conductor{adversarial_color(key, 32), adversarial_color(key, 35)};
  return p;
}

PhongParameters adversarial_phong(std::uint64_t key) {
  PhongParameters p;
  p.color = adversarial_color(key, 0), p.specular_color = adversarial_color(key, 3);
  float* const scalars[] = {&p.diffuse, &p.specular,   &p.phong,          &p.reflection, &p.transparency,
                            &p.ior,     &p.brilliance, &p.specular_blinn, &p.blinn};
  std::uint32_t d = 10;
  for (float* s : scalars) *s = adversarial(key, d++);
  return p;
}

void expect_sane(const BsdfValue& v) {
  ASSERT_TRUE(is_finite(v.value) && std::isfinite(v.pdf));
  ASSERT_GE(std::min({v.value.x, v.value.y, v.value.z, v.pdf}), 0);
}

/// Returns how many samples there were.
int expect_sane(const Bsdf& bsdf, const Vec3f& wo, std::uint64_t key) {
  int samples = 0;
  for (const Vec3f& wi : {random_above(key), -random_above(key), Vec3f{-wo.x, -wo.y, wo.z}, wo, -wo,
                          Vec3f{1, 0, 0}, Vec3f{0, 0, -1}, Vec3f{1, 0, 1e-30f}, Vec3f{0, -1, -1e-30f}})
    expect_sane(bsdf.evaluate(wi));
  for (std::uint32_t i = 0; i < 8; ++i) {
    const double ends[] = {0, 1 - 0x1p-53, 0.5, random_float(key, i, 40)};
    const auto s = bsdf.sample(i == 0   ? 0
                               : i == 1 ? 1 - 0x1p-24f
                                        : random_float(key, i, 41),
                               {ends[random_bits(key, i, 42) % 4], ends[random_bits(key, i, 43) % 4]});
    if (!s) continue;
    ++samples;
    expect_sane({s->weight, s->pdf});
    EXPECT_NEAR(length(s->direction), 1, 1e-5);
    EXPECT_EQ(s->delta, s->pdf == 0);
    EXPECT_EQ(s->transmitted, s->direction.z < 0);
  }
  return samples;
}

TEST(Bsdf, AnyFiniteParametersGiveFiniteValues) {
  int samples = 0;
  for (std::uint64_t n = 0; n < 20000; ++n) {
    const std::uint64_t key = mix_bits(n + 123456);
    constexpr double kCosines[] = {1, 1e-6, 1e-3, 0.5, 1e-12, 0.745};
    const Vec3f wo = direction_at(kCosines[n % 6], static_cast<double>(n));
    SCOPED_TRACE(n);
    samples += expect_sane(principled_bsdf(adversarial_principled(key), wo, n % 2 == 0), wo, key);
    samples += expect_sane(phong_bsdf(adversarial_phong(key), wo, n % 2 == 0), wo, key);
    if (HasFailure()) return;
  }
  EXPECT_GT(samples, 20000);  // of 320000 tries, many of which materials without light absorb
}

// A white surface never sends back more than arrives, however its layers are mixed.
TEST(Bsdf, MixturesGainNoEnergy) {
  for (std::uint64_t n = 0; n < 150; ++n) {
    const std::uint64_t key = mix_bits(n + 77);
    PrincipledParameters p;
    p.base_color = {1, 1, 1};
    float* const scalars[] = {&p.metallic,       &p.roughness, &p.transmission,   &p.coat,
                              &p.coat_roughness, &p.sheen,     &p.sheen_roughness};
    std::uint32_t d = 0;
    for (float* s : scalars) *s = random_float(key, 3, d++);
    p.thin = n % 4 == 0;
    const Vec3f wo = direction_at(0.05 + 0.95 * random_float(key, 3, 20), 1);
    expect_close(mean_weight(principled_bsdf(p, wo, n % 3 != 0), 400, 4), {1, 1, 1}, 0.04);
  }
}

}  // namespace
}  // namespace oktett::bsdf_test
