#include <gtest/gtest.h>

#include <optional>

#include "render/bsdf/bsdf.h"
#include "tests/render/bsdf_support.h"

namespace oktett::bsdf_sampling_test {
namespace {

constexpr int kRings = 12, kSectors = 8, kBins = kRings * kSectors;

/// A material seen from a direction, and where its lobes point to.
struct Setting {
  Bsdf bsdf;
  Vec3d mirrored, refracted;
};

Setting setting(Bsdf bsdf, const Vec3f& wo, double eta) {
  const double sine2 = (wo.x * wo.x + wo.y * wo.y) / (eta * eta);
  return {std::move(bsdf),
          {-wo.x, -wo.y, wo.z},
          {-wo.x / eta, -wo.y / eta, -(sine2 < 1 ? std::sqrt(1 - sine2) : 0.1)}};
}

/// The probabilities of bins about the two lobes, by integrals of the density.
std::vector<double> bin_probabilities(const Setting& s) {
  std::vector<double> bins;
  for (const bool above : {true, false}) {
    const PolarSquare square(above ? s.mirrored : s.refracted);
    const auto density = [&](double r, double t) {
      return s.bsdf.evaluate(Vec3f(square.direction(r, t))).pdf * square.density(r, t);
    };
    for (int i = 0; i < kBins; ++i) {
      const int ring = i / kSectors, sector = i % kSectors;
      bins.push_back(integral(density, ring / double{kRings}, (ring + 1) / double{kRings},
                              sector / double{kSectors}, (sector + 1) / double{kSectors}, 1e-6, 5));
    }
  }
  return bins;
}

int bin_of(const Setting& s, const Vec3f& w) {
  double r, t;
  PolarSquare(w.z > 0 ? s.mirrored : s.refracted).square(Vec3d(w), r, t);
  const int ring = std::min(kRings - 1, static_cast<int>(r * kRings));
  const int sector = std::min(kSectors - 1, static_cast<int>(t * kSectors));
  return (w.z > 0 ? 0 : kBins) + ring * kSectors + sector;
}

/// Draws samples and compares: their bins with the density, their weights with value / density.
void expect_samples_follow_density(const Setting& s, std::uint64_t key) {
  constexpr int kSamples = 20000;
  std::vector<double> expected = bin_probabilities(s), counted(2 * kBins + 1);
  double total = 0;
  for (double& e : expected) total += e, e *= kSamples;
  EXPECT_LE(total, 1 + 2e-4);
  // The last bin: absorbed, or of a delta lobe.
  expected.push_back(std::max(0.0, 1 - total) * kSamples);
  for (int i = 0; i < kSamples; ++i) {
    const std::optional<BsdfSample> sample =
        s.bsdf.sample(random_float(key, i, 0), {random_float(key, i, 1), random_float(key, i, 2)});
    if (!sample || sample->delta) {
      ++counted[2 * kBins];
      continue;
    }
    const Vec3f w = sample->direction;
    ++counted[bin_of(s, w)];
    const BsdfValue at = s.bsdf.evaluate(w);
    ASSERT_NEAR(length(w), 1, 1e-5);
    ASSERT_EQ(sample->transmitted, w.z < 0);
    ASSERT_GT(sample->pdf, 0);
    ASSERT_FLOAT_EQ(sample->pdf, at.pdf);
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(sample->weight[k] * at.pdf, at.value[k], 1e-5f * at.value[k]);
  }
  EXPECT_GT(chi2_probability(expected, counted), 1e-4);
}

template <class T, std::size_t N>
T any_of(const T (&list)[N], std::uint64_t key, std::uint32_t dimension) {
  return list[random_bits(key, 0, dimension) % N];
}

constexpr float kRoughness[] = {0.032f, 0.06f, 0.12f, 0.25f, 0.35f, 0.6f, 0.8f, 1};
constexpr double kCosine[] = {0.01, 0.05, 0.2, 0.5, 0.7, 0.9, 0.999, 1};
constexpr float kIor[] = {0.4f, 0.7f, 0.9f, 1.05f, 1.33f, 1.5f, 2.4f};
constexpr float kIorNearOne[] = {0.99f, 0.995f, 0.999f, 1, 1.001f, 1.005f, 1.01f, 1.02f, 1.03f};
constexpr float kWeight[] = {0, 0, 0.5f, 1};
constexpr float kScale[] = {0.5f, 1, 6, 40};
constexpr Color kColor[] = {{1, 1, 1}, {0.8f, 0.3f, 0.1f}, {0, 0, 0}, {0.1f, 0.9f, 0.5f}};

class PrincipledSets : public testing::TestWithParam<int> {};

// 30 sets for each kind of material, fewer where a value takes longer.
TEST_P(PrincipledSets, SamplesFollowTheDensity) {
  const int kind = GetParam();
  for (int n = 0; n < (kind < 10 ? 30 : 6); ++n) {
    const std::uint64_t key = mix_bits(1000 * kind + n);
    PrincipledParameters p;
    p.roughness = any_of(kRoughness, key, 0);
    p.ior = any_of(kIor, key, 1);
    p.base_color = any_of(kColor, key, 2);
    const double mu = any_of(kCosine, key, 3);
    const bool front = random_bits(key, 0, 4) % 2 == 0;
    if (kind == 0) p.metallic = 1;
    if (kind == 1) p.specular = any_of(kWeight, key, 5);
    if (kind == 2 || kind == 3) p.transmission = 1, p.thin = kind == 3;
    if (kind == 7) p.transmission = 1, p.ior = any_of(kIorNearOne, key, 1);
    if (kind == 4) p.metallic = 1, p.conductor.emplace();
    if (kind == 5)
      p.coat = 1, p.coat_roughness = any_of(kRoughness, key, 6), p.sheen = any_of(kWeight, key, 7);
    if (kind == 6) {
      p.metallic = any_of(kWeight, key, 5), p.transmission = any_of(kWeight, key, 6);
      p.coat = any_of(kWeight, key, 7), p.coat_roughness = any_of(kRoughness, key, 8);
      p.sheen = any_of(kWeight, key, 9), p.sheen_roughness = any_of(kRoughness, key, 10);
      p.thin = random_bits(key, 0, 11) % 4 == 0;
      if (random_bits(key, 0, 12) % 3 == 0) p.roughness = 0;
    }
    if (kind == 8) {
      p.specular_color = {any_of(kColor, key, 5) * any_of(kScale, key, 6)};
      p.specular_weight = any_of(kWeight, key, 7);
    }
    if (kind == 10 || kind == 11) {
      p.metallic = any_of(kWeight, key, 5), p.transmission = any_of(kWeight, key, 6);
      p.thin = random_bits(key, 0, 7) % 4 == 0;
      p.roughness = std::max(p.roughness, 0.12f);
      if (kind == 10) p.anisotropy = 0.1f + 0.9f * random_float(key, 0, 8);
      if (kind == 11) p.iridescence = 1, p.iridescence_ior = 1.8f, p.iridescence_thickness = 100.0f * n;
    }
    if (kind == 9) {
      // The bins are not dense about the lobe of the coat.
      p.coat = 1, p.coat_roughness = std::max(any_of(kRoughness, key, 6), 0.35f);
      p.roughness = std::max(p.roughness, 0.12f);
      p.coat_normal = direction_at(0.6 + 0.4 * random_float(key, 0, 7), n);
    }
    SCOPED_TRACE(testing::Message() << "set " << n << " roughness " << p.roughness << " ior " << p.ior
                                    << " cosine " << mu << " front " << front);
    const Vec3f wo = direction_at(mu, 1 + n);
    const double eta = p.thin ? 1 : front ? p.ior : 1 / p.ior;
    Setting s = setting(principled_bsdf(p, wo, front), wo, eta);
    if (kind == 7) s.refracted = refracted_by_facets(Vec3d(wo), p.roughness, eta);
    expect_samples_follow_density(s, key);
  }
}

std::string kind_name(const testing::TestParamInfo<int>& info) {
  static const char* const names[] = {"Metal",     "Opaque",     "Glass",     "Thin",
                                      "Conductor", "Layers",     "Mixtures",  "GlassNearOne",
                                      "Specular",  "TiltedCoat", "Stretched", "ThinFilm"};
  return names[info.param];
}

INSTANTIATE_TEST_SUITE_P(Bsdf, PrincipledSets, testing::Range(0, 12), kind_name);

TEST(BsdfPhong, SamplesFollowTheDensity) {
  constexpr float kExponent[] = {0, 0.5f, 1, 10, 32.5f, 1000, 30000};
  for (int n = 0; n < 40; ++n) {
    const std::uint64_t key = mix_bits(77000 + n);
    PhongParameters p;
    p.color = any_of(kColor, key, 0);
    p.diffuse = any_of(kWeight, key, 1);
    p.specular = any_of(kWeight, key, 2);
    p.phong = any_of(kExponent, key, 3);
    p.reflection = any_of(kWeight, key, 4);
    p.transparency = any_of(kWeight, key, 5);
    SCOPED_TRACE(testing::Message() << "set " << n << " exponent " << p.phong);
    const Vec3f wo = direction_at(any_of(kCosine, key, 6), n);
    expect_samples_follow_density(setting(phong_bsdf(p, wo, n % 2 == 0), wo, 1.5), key);
  }
}

TEST(BsdfPhong, SamplesOfBlinnAndBrillianceFollowTheDensity) {
  constexpr float kExponent[] = {0, 0.5f, 1, 10, 32.5f, 1000};
  for (int n = 0; n < 24; ++n) {
    const std::uint64_t key = mix_bits(78000 + n);
    PhongParameters p;
    p.diffuse = any_of(kWeight, key, 1), p.brilliance = any_of(kExponent, key, 2);
    p.specular_blinn = any_of(kWeight, key, 3), p.blinn = any_of(kExponent, key, 4);
    p.specular = n % 3 == 0 ? 0.5f : 0;
    SCOPED_TRACE(testing::Message() << "set " << n << ": " << p.brilliance << ", " << p.blinn);
    const Vec3f wo = direction_at(any_of(kCosine, key, 6), n);
    expect_samples_follow_density(setting(phong_bsdf(p, wo, true), wo, 1.5), key);
  }
}

}  // namespace
}  // namespace oktett::bsdf_sampling_test
