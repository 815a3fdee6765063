#include <gtest/gtest.h>
#include <numbers>

#include <cmath>
#include <limits>
#include <vector>

#include "core/error.h"
#include "render/light/environment_map.h"
#include "tests/render/light_checks.h"

namespace oktett::light_environment_test {
namespace {

using namespace light_checks;

EnvironmentPicture random_picture(std::uint32_t width, std::uint32_t height, std::uint64_t key) {
  Random random(key);
  EnvironmentPicture picture{width, height, {}};
  for (std::uint32_t i = 0; i < width * height; ++i) {
    const auto brightness = static_cast<float>(random() < 0.3 ? 0 : std::exp(random.between(-5, 5)));
    picture.pixels.push_back(Color{1, static_cast<float>(random()), 0.1f} * brightness);
  }
  return picture;
}

double mean(const Color& c) { return (double{c.x} + c.y + c.z) / 3; }

/// The integral of f over all directions: a random point in each cell of longitude and cosine, since the
/// cells may be parallel to the pixels.
template <class F>
double sphere_integral(int rows, F&& f) {
  Random random(static_cast<std::uint64_t>(rows));
  double sum = 0;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < 2 * rows; ++j) {
      const double z = -1 + (i + random()) * 2 / rows, angle = (j + random()) * std::numbers::pi / rows;
      const double r = std::sqrt(1 - z * z);
      sum += f(Vec3f(Vec3d{r * std::cos(angle), z, r * std::sin(angle)}));
    }
  return sum * 4 * std::numbers::pi / (2.0 * rows * rows);
}

// The picture as a viewer sees it who looks along -z with +y up.
TEST(EnvironmentMap, LiesAroundTheViewerAsDocumented) {
  // A row of four columns above a row of another colour.
  const EnvironmentPicture picture{
      4, 2, {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {0, 1, 0}, {0, 2, 0}, {0, 3, 0}, {0, 4, 0}}};
  const auto at = [&](const Vec3f& d, double rotation) {
    return EnvironmentMap(picture, {.rotation = rotation, .smooth = false}).radiance(normalize(d));
  };
  EXPECT_EQ(at({-0.1f, 0.5f, -1}, 0), (Color{2, 0, 0}));
  EXPECT_EQ(at({0.1f, 0.5f, -1}, 0), (Color{3, 0, 0}));
  EXPECT_EQ(at({0.1f, -0.5f, -1}, 0), (Color{0, 3, 0}));
  EXPECT_EQ(at({1, 0.1f, -0.1f}, 0), (Color{3, 0, 0}));
  EXPECT_EQ(at({1, 0.1f, 0.1f}, 0), (Color{4, 0, 0}));
  EXPECT_EQ(at({-1, 0.1f, 0.1f}, 0), (Color{1, 0, 0}));
  // What was ahead at -z is, turned by a quarter counter-clockwise as seen from above, at -x.
  EXPECT_EQ(at({-1, 0.5f, 0.1f}, std::numbers::pi / 2), (Color{2, 0, 0}));
  EXPECT_EQ(at({-1, 0.5f, -0.1f}, std::numbers::pi / 2), (Color{3, 0, 0}));
}

// Frequencies of pixels against their radiance times their solid angle; without interpolation, the oracle
// needs no more than the picture.
TEST(EnvironmentMap, ChoosesPixelsByRadianceTimesSolidAngle) {
  const EnvironmentPicture picture = random_picture(12, 9, 1);
  const EnvironmentMap map(picture, {.smooth = false});
  constexpr int kSamples = 100000;
  std::vector<double> expected(picture.pixels.size()), counted(picture.pixels.size());
  double total = 0;
  for (std::uint32_t i = 0; i < picture.pixels.size(); ++i) {
    const std::uint32_t row = i / 12;
    expected[i] = mean(picture.pixels[i]) *
                  (std::cos(std::numbers::pi * row / 9) - std::cos(std::numbers::pi * (row + 1) / 9));
    total += expected[i];
  }
  for (double& e : expected) e *= kSamples / total;
  Random random(2);
  for (int i = 0; i < kSamples; ++i) {
    const EnvironmentMap::Sample s = map.sample(random.square());
    const auto column = static_cast<std::size_t>(s.u * 12), row = static_cast<std::size_t>(s.v * 9);
    ++counted[row * 12 + column];
    ASSERT_EQ(s.radiance, picture.pixels[row * 12 + column]);
    // The density is proportional to the radiance.
    ASSERT_NEAR(s.pdf * 4 * std::numbers::pi * map.mean_radiance() / mean(s.radiance), 1, 1e-5);
  }
  EXPECT_LT(chi_squared(expected, counted), 4);
}

TEST(EnvironmentMap, SamplesHaveTheDensityThatPdfSays) {
  for (const bool smooth : {false, true})
    for (const bool compensate : {false, true})
      for (const auto& [width, height] : {std::pair{8u, 4u}, {7u, 5u}, {1u, 1u}, {1u, 6u}, {6u, 1u}}) {
        SCOPED_TRACE(testing::Message()
                     << width << " x " << height << ", smooth " << smooth << ", compensated " << compensate);
        const EnvironmentMap map(random_picture(width, height, 3 + width),
                                 {.rotation = 1, .smooth = smooth, .compensate = compensate});
        if (!map.samples()) {
          EXPECT_EQ(map.pdf({0, 1, 0}), 0);
          continue;
        }
        EXPECT_NEAR(sphere_integral(300, [&](const Vec3f& d) { return map.pdf(d); }), 1, 0.02);
        EXPECT_NEAR(sphere_integral(300, [&](const Vec3f& d) { return mean(map.radiance(d)); }) /
                        (4 * std::numbers::pi * map.mean_radiance()),
                    1, smooth ? 0.1 : 0.02);
        constexpr int kSamples = 20000;
        std::vector<double> expected(6 * 36), counted(6 * 36);
        sphere_integral(400, [&](const Vec3f& d) {
          return expected[cube_cell(Vec3d(d), 6)] +=
                 map.pdf(d) * kSamples * 4 * std::numbers::pi / (2.0 * 400 * 400);
        });
        for (double& e : expected) e = std::max(e, 1e-9);
        Random random(4);
        int other = 0;
        for (int i = 0; i < kSamples; ++i) {
          const EnvironmentMap::Sample s = map.sample(random.square());
          ASSERT_NEAR(length(s.direction), 1, 1e-6f);
          ASSERT_TRUE(s.pdf > 0 && std::isfinite(s.pdf) && is_finite(s.radiance));
          ++counted[cube_cell(Vec3d(s.direction), 6)];
          // But for directions that rounding puts into the next pixel.
          if (std::abs(map.pdf(s.direction) - s.pdf) > 1e-5f * s.pdf) ++other;
          ASSERT_NEAR(mean(map.radiance(s.direction)), mean(s.radiance),
                      smooth ? 1e-3 * (1 + mean(s.radiance)) : 1e4);
        }
        EXPECT_LE(other, 10);
        EXPECT_LT(chi_squared(expected, counted), 4);
      }
}

// With interpolation, light comes from black pixels beside bright ones: the density is not 0 there.
TEST(EnvironmentMap, IsSampledWhereverItIsBright) {
  EnvironmentPicture picture{16, 8, std::vector<Color>(128)};
  picture.pixels[3 * 16 + 15] = {1000, 1000, 1000};
  picture.pixels[0] = {0, 5, 0};
  const EnvironmentMap map(picture);
  Random random(5);
  int bright = 0;
  for (int i = 0; i < 100000; ++i) {
    const Vec3f d = random.direction();
    if (mean(map.radiance(d)) > 0) {
      ++bright;
      ASSERT_GT(map.pdf(d), 0);
    }
  }
  EXPECT_GT(bright, 1000);
}

TEST(EnvironmentMap, FindsASingleBrightPixel) {
  for (const std::uint32_t row : {0u, 100u, 511u}) {
    EnvironmentPicture picture{1024, 512, std::vector<Color>(1024 * 512)};
    picture.pixels[row * 1024 + 300] = {1e6f, 1e6f, 1e6f};
    const EnvironmentMap map(picture, {.rotation = -2, .smooth = false});
    const double angle =
        2 * std::numbers::pi / 1024 *
        (std::cos(std::numbers::pi * row / 512) - std::cos(std::numbers::pi * (row + 1) / 512));
    Random random(6);
    for (int i = 0; i < 1000; ++i) {
      const EnvironmentMap::Sample s = map.sample(random.square());
      ASSERT_NEAR(s.pdf * angle, 1, 1e-5);
      ASSERT_EQ(s.radiance.x, 1e6f);
      ASSERT_EQ(static_cast<int>(s.u * 1024), 300);
    }
  }
}

TEST(EnvironmentMap, OfOneColourIsUniformAndNeedsNoSamplesIfCompensated) {
  const EnvironmentPicture picture{32, 16, std::vector<Color>(512, Color{2, 2, 2})};
  const EnvironmentMap map(picture);
  EXPECT_NEAR(map.mean_radiance(), 2, 1e-9);
  Random random(7);
  for (int i = 0; i < 1000; ++i) {
    const EnvironmentMap::Sample s = map.sample(random.square());
    ASSERT_NEAR(s.pdf, 1 / (4 * std::numbers::pi), 1e-7);
    ASSERT_NEAR(s.radiance.x, 2, 1e-6f);
    ASSERT_NEAR(map.pdf(random.direction()), 1 / (4 * std::numbers::pi), 1e-7);
  }
  const EnvironmentMap compensated(picture, {.compensate = true});
  EXPECT_FALSE(compensated.samples());
  EXPECT_EQ(compensated.pdf({1, 0, 0}), 0);
  EXPECT_NEAR(compensated.radiance({1, 0, 0}).x, 2, 1e-6f);
}

TEST(EnvironmentMap, HasNoSamplesIfBlackAndTakesBadPixelsForBlack) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const EnvironmentMap black({2, 2, std::vector<Color>(4)});
  EXPECT_FALSE(black.samples());
  EXPECT_EQ(black.pdf({0, 0, 1}), 0);
  EXPECT_EQ(black.radiance({0, 0, 1}), Color{});
  const EnvironmentMap bad({2, 2, {{nan, -1, inf}, {nan, nan, nan}, {-inf, 0, 0}, {-5, -5, -5}}});
  EXPECT_FALSE(bad.samples());
  EXPECT_EQ(bad.radiance({0, 0, 1}), Color{});
  EXPECT_THROW(EnvironmentMap({0, 0, {}}), Error);
  EXPECT_THROW(EnvironmentMap({2, 2, std::vector<Color>(3)}), Error);
  // The directions of the poles and of the seam.
  for (const Vec3f& d :
       {Vec3f{0, 1, 0}, Vec3f{0, -1, 0}, Vec3f{0, 0, 1}, Vec3f{-0.0f, 0, 1}, Vec3f{nan, nan, nan}, Vec3f{}})
    EXPECT_EQ(EnvironmentMap(random_picture(5, 4, 1)).pdf(d) >= 0, true);
}

// The average of radiance / pdf is the light of all directions, for half of the samples as for the other:
// numbers from the unit square keep their order, so even patterns stay even.
TEST(EnvironmentMap, MapsEvenPatternsToEvenSamples) {
  const EnvironmentMap map(random_picture(16, 8, 9));
  double sum = 0;
  constexpr int kEdge = 100;
  for (int i = 0; i < kEdge * kEdge; ++i) {
    const EnvironmentMap::Sample s = map.sample({(i % kEdge + 0.5) / kEdge, (i / kEdge + 0.5) / kEdge});
    sum += mean(s.radiance) / s.pdf / (kEdge * kEdge);
  }
  const double light = sphere_integral(500, [&](const Vec3f& d) { return mean(map.radiance(d)); });
  EXPECT_NEAR(sum / light, 1, 0.01);
}

}  // namespace
}  // namespace oktett::light_environment_test
