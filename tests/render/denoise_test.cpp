/// \file The denoiser: error against long renders, what it must leave alone.

#include "render/film/denoise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/random.h"
#include "render/film/film.h"
#include "tests/render/test_scenes.h"

namespace oktett::denoise_test {
namespace {

using namespace test;

/// Mean squared relative error of the green channel.
double error(const Picture& p, const Picture& truth) {
  double sum = 0;
  const std::size_t size = truth.find("G")->values.size();
  for (std::size_t i = 0; i < size; ++i) {
    const auto a = static_cast<double>(p.find("G")->values[i]),
               b = static_cast<double>(truth.find("G")->values[i]);
    sum += (a - b) * (a - b) / (b * b + 0.01);
  }
  return sum / static_cast<double>(size);
}

/// A room of coloured walls lit by a lamp, with a ball in it.
Scene room() {
  Scene scene = bare_scene(64);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.depth = 4;
  scene.camera.from = {0, 0, 3.4};
  const auto wall = [&](const Vec3d& normal, double offset, const Color& color) {
    add_object(scene, PlaneShape{normal, offset}, add_material(scene, diffuse(color)));
  };
  wall({0, 1, 0}, -1, {0.7f, 0.7f, 0.7f}), wall({0, -1, 0}, -1, {0.7f, 0.7f, 0.7f});
  wall({1, 0, 0}, -1, {0.7f, 0.1f, 0.1f}), wall({-1, 0, 0}, -1, {0.1f, 0.6f, 0.1f});
  wall({0, 0, 1}, -1, {0.7f, 0.7f, 0.7f});
  wall({0, 0, -1}, -4, {0.7f, 0.7f, 0.7f});
  add_object(scene, SphereShape{{0.3, -0.6, 0}, 0.4}, 0);
  add_object(scene, SphereShape{{0, 0.8, 0}, 0.12}, add_material(scene, glowing({20, 20, 20})));
  return scene;
}

/// Balls of matt and shiny material on a floor under a bright sky.
Scene balls() {
  Scene scene = bare_scene(64);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.depth = 3;
  scene.camera.from = {0, 2, 6};
  scene.lights = {SkyLight{}};
  const std::uint32_t white = add_material(scene, diffuse({0.8f, 0.8f, 0.8f}));
  add_object(scene, PlaneShape{{0, 1, 0}, -1}, white);
  Material shiny = diffuse({0.8f, 0.2f, 0.1f});
  shiny.principled = PrincipledMaterial{};
  shiny.principled->parameters.base_color = shiny.color, shiny.principled->parameters.roughness = 0.3f;
  add_object(scene, SphereShape{{-1.1, 0, 0}, 1}, add_material(scene, shiny));
  add_object(scene, SphereShape{{1.1, 0, 0.3}, 1}, white);
  return scene;
}

TEST(Denoise, TheErrorFalls) {
  for (const bool first : {true, false}) {
    Scene scene = first ? room() : balls();
    scene.integrator.samples = 1024, scene.integrator.seed = 5;
    const Picture truth = run(scene).picture;
    for (const std::uint32_t samples : {16u, 64u}) {
      scene.integrator.samples = samples, scene.integrator.seed = 0;
      Picture picture = run(scene).picture;
      const double before = error(picture, truth);
      denoise(picture);
      const double after = error(picture, truth);
      RecordProperty((first ? "room_" : "balls_") + std::to_string(samples), std::to_string(before / after));
      // The sky leaves little noise but at edges, which stay. With these seeds the room has factors of 6.9
      // and 4.3 (16 and 64 samples), the balls of 2.1 and 1.9. The bounds are a fifth and a tenth below the
      // smaller ones: room for other random numbers, not for a denoiser that does half as much.
      EXPECT_LT(after, before / (first ? 3.5 : 1.7))
          << first << ' ' << samples << ": " << before << ' ' << after;
    }
  }
}

// Without noise nothing changes, edges and gradients included.
TEST(Denoise, NoiselessPicturesStay) {
  Scene scene = bare_scene(40);
  scene.background = {0.2f, 0.5f, 1};
  scene.lights = {PointLight{{3, 4, 5}, {1, 1, 1}, false}};
  add_object(scene, SphereShape{{0, 0, 0}, 1}, add_material(scene, diffuse({1, 0.5f, 0.2f})));
  const Picture before = run(scene).picture;
  Picture after = before;
  denoise(after);
  for (const char* channel : {"R", "G", "B"})
    for (std::size_t i = 0; i < 1600; ++i) {
      ASSERT_EQ(after.find(channel)->values[i], before.find(channel)->values[i]);
      ASSERT_EQ(after.find(std::string("Noisy.") + channel)->values[i], before.find(channel)->values[i]);
    }
}

/// A picture with all planes, grey of 0.5 with noise of known variance.
Picture noise(std::uint32_t size, float deviation) {
  Picture p = run(bare_scene(size)).picture;
  for (std::size_t i = 0; i < p.find("R")->values.size(); ++i) {
    for (const char* channel : {"R", "G", "B"}) {
      p.find(channel)->values[i] =
          0.5f + deviation * (random_float(3, static_cast<std::uint32_t>(i), 0) - 0.5f);
      p.find(std::string("Variance.") + channel)->values[i] = deviation * deviation / 12;
    }
  }
  return p;
}

TEST(Denoise, PureNoiseBecomesFlat) {
  Picture p = noise(64, 0.4f);
  denoise(p);
  double mean = 0, variance = 0;
  for (const float v : p.find("G")->values) mean += static_cast<double>(v) / 4096;
  for (const float v : p.find("G")->values) variance += (static_cast<double>(v) - mean) * (v - mean) / 4096;
  EXPECT_NEAR(mean, 0.5, 0.01);
  EXPECT_LT(variance, 0.4 * 0.4 / 12 / 30);
}

// An edge of features stays sharp although noise hides it.
TEST(Denoise, FeaturesKeepEdges) {
  Picture p = noise(64, 0.8f);
  for (std::uint32_t y = 0; y < 64; ++y)
    for (std::uint32_t x = 32; x < 64; ++x) {
      for (const char* channel : {"R", "G", "B"}) p.find(channel)->values[y * 64 + x] += 0.5f;
      p.find("N.X")->values[y * 64 + x] = 1;
    }
  denoise(p);
  double left = 0, right = 0;
  for (std::uint32_t y = 0; y < 64; ++y)
    left += static_cast<double>(value(p, "G", 31, y)) / 64,
        right += static_cast<double>(value(p, "G", 32, y)) / 64;
  EXPECT_NEAR(right - left, 0.5, 0.07);
}

// Depth counts relative to the nearest one, so that the scene's unit of length does not matter.
TEST(Denoise, TheUnitOfLengthDoesNotMatter) {
  Picture near = noise(32, 0.5f);
  for (std::uint32_t i = 0; i < 32 * 32; ++i) near.find("Z")->values[i] = i % 32 < 16 ? 1.0f : 1.5f;
  Picture far = near;
  for (float& z : far.find("Z")->values) z *= 1024;
  denoise(near), denoise(far);
  EXPECT_TRUE(std::equal(near.find("G")->values.begin(), near.find("G")->values.end(),
                         far.find("G")->values.begin()));
}

TEST(Denoise, BadPixelsAndOddSizesDoNoHarm) {
  for (const std::uint32_t size : {1u, 2u, 65u}) {
    Picture p = noise(size, 0.4f);
    p.find("G")->values[0] = std::numeric_limits<float>::quiet_NaN();
    p.find("Variance.R")->values[0] = std::numeric_limits<float>::infinity();
    p.find("N.Y")->values[size - 1] = std::numeric_limits<float>::quiet_NaN();
    denoise(p);
    for (const char* channel : {"R", "G", "B"})
      for (const float v : p.find(channel)->values) ASSERT_TRUE(std::isfinite(v));
  }
}

// Two pixels p and q that differ in colour alone. The distance is the mean over the channels of
// ((p - q)^2 - (Var p + min(Var p, Var q))) / (strength^2 (Var p + Var q)), and the weight (1 + d / 16)^-16.
TEST(Denoise, StrengthCountsStandardDeviations) {
  FilmFormat format;
  format.window = {0, 0, 2, 1};
  format.full_width = 2, format.data_layers = true;
  const double colors[3][2] = {{1, 0.5}, {0.4, 0.7}, {0.25, 0.25}};
  for (const double strength : {0.5, 1.0, 2.0}) {
    Picture p = make_picture(format);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string channel(1, "RGB"[k]);
      for (std::size_t i = 0; i < 2; ++i) {
        p.find(channel)->values[i] = static_cast<float>(colors[k][i]);
        // With what the denoiser adds to it this is 1.
        p.find("Albedo." + channel)->values[i] = 0.95f;
        // Means over five pixels, with the border repeated: 0.04 and 0.05.
        p.find("Variance." + channel)->values[i] = i == 0 ? 0.02f : 0.07f;
      }
    }
    DenoiseOptions options;
    options.window = 1, options.patch = 0, options.strength = static_cast<float>(strength);
    denoise(p, options);
    for (std::size_t i = 0; i < 2; ++i) {
      // (p - q)^2 is 0.25, 0.09 and 0.
      const double noise_of_three = i == 0 ? 3 * 0.08 : 3 * 0.09;
      const double distance = (0.34 - noise_of_three) / (3 * strength * strength * 0.09);
      const double weight = std::pow(1 + distance / 16, -16);
      for (std::size_t k = 0; k < 3; ++k) {
        const double want = (colors[k][i] + weight * colors[k][1 - i]) / (1 + weight);
        EXPECT_NEAR(p.find(std::string(1, "RGB"[k]))->values[i], want, 1e-5)
            << strength << ' ' << i << ' ' << k;
      }
    }
  }
}

TEST(Denoise, NeedsItsLayers) {
  Picture p = run(bare_scene(4), [](RenderOptions& o) { o.data_layers = false; }).picture;
  EXPECT_THROW(denoise(p), Error);
  EXPECT_EQ(p.planes.size(), 4u);
}

}  // namespace
}  // namespace oktett::denoise_test
