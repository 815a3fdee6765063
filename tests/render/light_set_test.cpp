#include "render/light/light_set.h"

#include <gtest/gtest.h>
#include <numbers>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/render/light_checks.h"

namespace oktett::light_set_test {
namespace {

using namespace light_checks;

constexpr Color kWhite{1, 1, 1};

std::shared_ptr<const EnvironmentMap> sky_map(const EnvironmentOptions& options = {}) {
  EnvironmentPicture picture{16, 8, std::vector<Color>(128)};
  Random random(77);
  for (Color& c : picture.pixels)
    c = Color{static_cast<float>(random()), static_cast<float>(random()), static_cast<float>(random())};
  return std::make_shared<EnvironmentMap>(picture, options);
}

/// One emitter of each kind.
std::vector<Emitter> all_kinds() {
  return {TriangleEmitter{{-1, -1, 3}, {-1, 1, 3}, {1, -1, 3.5f}, {2, 1, 1}},
          RectangleEmitter{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 2, 1}, true},
          DiskEmitter{{-2, 0, 1}, {1, 0, 0}, 0.5f, {1, 1, 2}},
          SphereEmitter{{0, 3, 2}, 0.5f, {3, 3, 3}},
          PointEmitter{{1, -2, 2}, {2, 2, 2}},
          PointEmitter{{5, 5, 5}, {0.1f, 0.1f, 0.1f}, false},
          SpotEmitter{{-1, 2, 3}, normalize(Vec3f{1, -2, -3}), {5, 5, 5}, 0.9f, 0.6f},
          DirectionalEmitter{normalize(Vec3f{1, 1, 1}), {0.2f, 0.2f, 0.2f}},
          DirectionalEmitter{normalize(Vec3f{-1, 1, 2}), {0.3f, 0.3f, 0.3f}, 0.5f},
          EnvironmentEmitter{sky_map()}};
}

TEST(LightSet, IsEmptyWithoutLight) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  EnvironmentPicture black{2, 1, std::vector<Color>(2)};
  const LightSet set({TriangleEmitter{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, kWhite},
                      TriangleEmitter{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}},
                      TriangleEmitter{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, -1, -1}},
                      TriangleEmitter{{0, 0, nan}, {1, 0, 0}, {0, 1, 0}, kWhite},
                      TriangleEmitter{{0, 0, 0}, {inf, 0, 0}, {0, 1, 0}, kWhite},
                      RectangleEmitter{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, kWhite},
                      DiskEmitter{{0, 0, 0}, {0, 0, 1}, 0, kWhite},
                      DiskEmitter{{0, 0, 0}, {0, 0, 1}, -1, kWhite},
                      DiskEmitter{{0, 0, 0}, {0, 0, 0}, 1, kWhite}, SphereEmitter{{0, 0, 0}, 0, kWhite},
                      PointEmitter{{0, 0, 0}, {nan, 0, 0}}, PointEmitter{{0, 0, 0}, {inf, 0, 0}},
                      DirectionalEmitter{{0, 0, 1}, {0, 0, 0}, 0.1f}, EnvironmentEmitter{},
                      EnvironmentEmitter{std::make_shared<EnvironmentMap>(black)}});
  EXPECT_TRUE(set.empty());
  const LightPoint point{{0.2f, 0.2f, 1}, {0, 0, -1}};
  EXPECT_FALSE(set.sample(point, 0.5, {0.5, 0.5}));
  EXPECT_EQ(set.environment_radiance({0, 0, 1}), Color{});
  EXPECT_EQ(set.environment_pdf(point, {0, 0, 1}), 0);
  for (std::uint32_t i = 0; i < set.emitters().size(); ++i) {
    EXPECT_EQ(set.pdf(point, i, {0, 0, -1}, 1), 0);
    EXPECT_EQ(set.probability(point, i), 0);
  }
  EXPECT_TRUE(LightSet().empty());
  EXPECT_FALSE(LightSet().sample(point, 0.5, {0.5, 0.5}));
  EXPECT_EQ(LightSet().environment_pdf(point, {0, 0, 1}), 0);
}

TEST(LightSet, ProbabilitiesSumToOneAndSayHowOftenEmittersAreChosen) {
  const LightSet set(all_kinds());
  Random random(1);
  int compared = 0;
  for (int i = 0; i < 20; ++i) {
    const LightPoint point{random.direction() * 2.0f, random.direction(), i % 2 == 0};
    std::vector<double> expected, counted(set.emitters().size());
    double sum = 0;
    for (std::uint32_t j = 0; j < set.emitters().size(); ++j) {
      sum += set.probability(point, j);
      expected.push_back(set.probability(point, j) * 20000);
    }
    ASSERT_NEAR(sum, 1, 1e-9);
    for (int j = 0; j < 20000; ++j)
      if (const auto s = set.sample(point, random(), random.square())) {
        ++counted[s->emitter];
        ASSERT_TRUE(s->pdf > 0 && std::isfinite(s->pdf) && is_finite(s->radiance));
      }
    for (std::size_t j = 0; j < expected.size(); ++j) {
      // Emitters that cannot light the point give no samples.
      const bool dark = counted[j] == 0 && expected[j] > 20;
      if (dark) {
        for (int k = 0; k < 100; ++k) ASSERT_FALSE(sample_emitter(set.emitters()[j], point, random.square()));
        continue;
      }
      EXPECT_NEAR(counted[j], expected[j], 5 * std::sqrt(expected[j]) + 1);
      compared += counted[j] > 0;
    }
  }
  EXPECT_GT(compared, 100);  // of 20 points and 10 emitters
}

TEST(LightSet, PdfIsThatOfTheSample) {
  const LightSet set(all_kinds());
  Random random(2);
  int deltas = 0, distant = 0, near = 0;
  for (int i = 0; i < 20000; ++i) {
    const LightPoint point{random.direction() * 2.0f, random.direction()};
    const auto s = set.sample(point, random(), random.square());
    if (!s) continue;
    ++(s->delta ? deltas : std::isinf(s->distance) ? distant : near);
    if (s->delta) {
      EXPECT_EQ(set.pdf(point, s->emitter, s->direction, s->distance), 0);
      EXPECT_NEAR(s->pdf, set.probability(point, s->emitter), 1e-6);
    } else if (std::isinf(s->distance)) {
      EXPECT_EQ(set.environment_pdf(point, s->direction), s->pdf);
      EXPECT_EQ(set.environment_radiance(s->direction), s->radiance);
    } else {
      EXPECT_NEAR(set.pdf(point, s->emitter, s->direction, s->distance) / s->pdf, 1, 1e-3);
    }
  }
  EXPECT_GT(std::min({deltas, distant, near}), 1000);
}

// The light of all emitters together is the sum of the light of each.
TEST(LightSet, SumsTheLightOfAllEmitters) {
  const std::vector<Emitter> emitters = all_kinds();
  const LightSet set(emitters);
  Random random(3);
  const auto irradiance = [&](const LightSet& lights, const LightPoint& point, int samples, double& error) {
    double sum = 0, squares = 0;
    for (int i = 0; i < samples; ++i) {
      const auto s = lights.sample(point, random(), random.square());
      if (!s) continue;
      const double value = s->radiance.x * std::max(0.0f, dot(s->direction, point.normal)) / s->pdf;
      sum += value, squares += value * value;
    }
    error = std::sqrt(std::max(0.0, squares / samples - sum / samples * (sum / samples)) / samples);
    return sum / samples;
  };
  int lit = 0;
  for (int i = 0; i < 10; ++i) {
    const LightPoint point{random.direction(), random.direction(), true};
    double expected = 0, variance = 0, error;
    for (const Emitter& e : emitters) {
      expected += irradiance(LightSet({e}), point, 4000, error);
      variance += error * error;
    }
    const double mean = irradiance(set, point, 100000, error);
    EXPECT_NEAR(mean, expected, 4 * std::sqrt(variance + error * error)) << i;
    lit += mean > 0;
  }
  EXPECT_EQ(lit, 10);
}

// Rays in random directions, which see discs of the sun and the sky behind them, give the same light.
TEST(LightSet, RaysThatLeaveTheSceneSeeWhatSamplesBring) {
  const LightSet set({DirectionalEmitter{normalize(Vec3f{-1, 1, 2}), {3, 3, 3}, 0.5f},
                      DirectionalEmitter{normalize(Vec3f{-1, 1, 1.8f}), {1, 1, 1}, 0.7f},
                      DirectionalEmitter{normalize(Vec3f{1, 1, 1}), {9, 9, 9}},
                      EnvironmentEmitter{sky_map()}});
  Random random(4);
  const LightPoint point{};
  double sampled = 0, seen = 0, mass = 0;
  constexpr int kSamples = 200000;
  for (int i = 0; i < kSamples; ++i) {
    if (const auto s = set.sample(point, random(), random.square()); s && !s->delta)
      sampled += s->radiance.x / s->pdf / kSamples;
    const Vec3f d = random.direction();
    seen += set.environment_radiance(d).x * 4 * std::numbers::pi / kSamples;
    mass += set.environment_pdf(point, d) * 4 * std::numbers::pi / kSamples;
  }
  EXPECT_NEAR(sampled, seen, 0.05 * seen);
  EXPECT_NEAR(mass, 1 - set.probability(point, 2), 0.05);
}

}  // namespace
}  // namespace oktett::light_set_test
