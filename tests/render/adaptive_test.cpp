/// \file Adaptive sampling: numbers of samples, freedom from bias, stated against true error.

#include "render/film/tile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/render/test_scenes.h"

namespace oktett::adaptive_test {
namespace {

using namespace test;

LuminanceSums sums(std::initializer_list<float> grey) {
  LuminanceSums s;
  for (const float v : grey) s.add({v, v, v});
  return s;
}

IntegratorSettings settings(std::uint32_t samples, double error, std::uint32_t most) {
  IntegratorSettings s;
  s.samples = samples, s.error = error, s.max_samples = most;
  return s;
}

// Samples 0 and 2 in turn have the mean 1 and, of four, the variance 4 / 3: for an error of E, 4 / (3 E^2).
TEST(Adaptive, CountsLuminance) {
  LuminanceSums sums;
  const double weights[] = {0.2126, 0.7152, 0.0722};  // of Rec. 709
  for (int k = 0; k < 3; ++k) {
    LuminanceSums one;
    Color c;
    c[k] = 2;
    one.add(c), sums.add(c);
    EXPECT_NEAR(one.sum, 2 * weights[k], 1e-12);
    EXPECT_NEAR(one.square, 4 * weights[k] * weights[k], 1e-12);
  }
  EXPECT_NEAR(sums.sum, 2, 1e-12);
  EXPECT_EQ(sums.count, 3u);
}

TEST(Adaptive, CountsFollowFromVariance) {
  const auto wanted = [](double error, std::uint32_t most) {
    ErrorEstimate estimate;
    for (int i = 0; i < 5; ++i) estimate.add_neighbour(sums({0, 2, 0, 2}));
    return estimate.samples_wanted(settings(4, error, most));
  };
  EXPECT_EQ(wanted(1, 1024), 4u);
  EXPECT_EQ(wanted(0.5, 1024), 8u);    // 5.3
  EXPECT_EQ(wanted(0.34, 1024), 12u);  // 11.5
  EXPECT_EQ(wanted(0.25, 1024), 24u);  // 21.3
  EXPECT_EQ(wanted(0.1, 1024), 192u);  // 133
  EXPECT_EQ(wanted(0.1, 101), 100u);
  EXPECT_EQ(wanted(0.1, 3), 4u);
  EXPECT_EQ(wanted(1e-9, 65536), 65536u);
}

TEST(Adaptive, FlatAndBlackNeedNothingMore) {
  for (const float grey : {0.0f, 1e-20f, 0.3f, 1e6f}) {
    ErrorEstimate estimate;
    estimate.add_neighbour(sums({grey, grey, grey, grey}));
    EXPECT_EQ(estimate.samples_wanted(settings(4, 0.01, 1024)), 4u);
  }
  EXPECT_EQ(ErrorEstimate().samples_wanted(settings(4, 0.01, 1024)), 4u);
  // Nearly black counts as kDarkestLight.
  ErrorEstimate dark;
  dark.add_neighbour(sums({0, 2e-4f, 0, 2e-4f}));
  EXPECT_EQ(dark.samples_wanted(settings(4, 0.01, 1024)), 4u);
}

/// A floor lit by a small bright lamp behind a screen with a hole, in part through a rough mirror: rare
/// bright samples.
Scene hard_scene(std::uint32_t samples) {
  Scene scene = bare_scene(32);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = samples, scene.integrator.depth = 3;
  scene.camera.from = {0, 3, 6};
  const std::uint32_t white = add_material(scene, diffuse({0.8f, 0.7f, 0.6f}));
  add_object(scene, PlaneShape{{0, 1, 0}, -1}, white);
  add_object(scene, SphereShape{{0.6, -0.3, 0}, 0.7}, white);
  Material shiny = diffuse({0.2f, 0.2f, 0.2f});
  shiny.principled = PrincipledMaterial{};
  shiny.principled->parameters.metallic = 1, shiny.principled->parameters.roughness = 0.3f;
  shiny.principled->parameters.base_color = {0.9f, 0.8f, 0.5f};
  add_object(scene, SphereShape{{-1, -0.2, 0.5}, 0.8}, add_material(scene, shiny));
  add_object(scene, SphereShape{{2, 3, 1}, 0.3}, add_material(scene, glowing({60, 60, 60})));
  add_object(scene, BoxShape{{1.2, 1.8, -2}, {1.6, 2.2, 3}}, white);
  return scene;
}

// The mean of pixels whose number of samples is decided by their neighbours has no bias: over 1024 pixels the
// difference to another render is what its variance says, in the sum and in blocks.
TEST(Adaptive, TheMeanIsUnbiased) {
  Scene scene = hard_scene(8);
  double total = 0, total_variance = 0, squares = 0;
  int blocks = 0;
  scene.integrator.samples = 1024;
  scene.integrator.seed = 99;
  const Picture reference = run(scene).picture;
  scene.integrator.samples = 8;
  scene.integrator.error = 0.1, scene.integrator.max_samples = 256;
  for (std::uint32_t seed = 0; seed < 16; ++seed) {
    scene.integrator.seed = seed;
    const Picture p = run(scene).picture;
    for (std::uint32_t by = 0; by < 32; by += 4)
      for (std::uint32_t bx = 0; bx < 32; bx += 4) {
        double sum = 0, variance = 0;
        for (std::uint32_t y = by; y < by + 4; ++y)
          for (std::uint32_t x = bx; x < bx + 4; ++x) {
            sum += value(p, "G", x, y) - value(reference, "G", x, y);
            variance += value(p, "Variance.G", x, y);
          }
        total += sum, total_variance += variance;
        if (variance > 0) squares += sum * sum / variance, ++blocks;
      }
  }
  // The reference's own error counts as often as it is compared.
  double reference_variance = 0;
  for (const float v : reference.find("Variance.G")->values) reference_variance += static_cast<double>(v);
  EXPECT_LT(std::abs(total), 3.5 * std::sqrt(total_variance + 16 * 16 * reference_variance));
  // Samples are stratified, so the variance is less than that of independent ones. Long tails make it more.
  EXPECT_GT(blocks, 900);
  EXPECT_LT(squares / blocks, 1.3);
}

/// The mean light of a picture over some seeds, and its standard deviation.
struct MeanLight {
  double mean = 0, deviation = 0;
};

MeanLight mean_light(Scene scene, std::uint32_t seeds) {
  double sum = 0, square = 0;
  for (std::uint32_t seed = 0; seed < seeds; ++seed) {
    scene.integrator.seed = seed;
    const Picture p = run(scene, [](RenderOptions& o) { o.data_layers = false; }).picture;
    double light = 0;
    for (const float x : p.find("G")->values) light += static_cast<double>(x) / (p.width * p.height);
    sum += light, square += light * light;
  }
  const double mean = sum / seeds, variance = std::max(0.0, square / seeds - mean * mean);
  return {mean, std::sqrt(variance / (seeds - 1))};
}

void expect_same_mean(Scene scene, std::uint32_t seeds, double error, std::uint32_t most) {
  const std::uint32_t first = scene.integrator.samples;
  scene.integrator.samples = most;
  const MeanLight want = mean_light(scene, seeds);
  scene.integrator.samples = first, scene.integrator.error = error, scene.integrator.max_samples = most;
  const MeanLight got = mean_light(scene, seeds);
  const double deviation = std::hypot(want.deviation, got.deviation);
  EXPECT_LT(deviation, 0.05 * want.mean) << "the test sees a bias of 20 %";
  EXPECT_LT(std::abs(got.mean - want.mean), 4 * deviation) << got.mean << " instead of " << want.mean;
}

// All pixels ask the same passes of photons, of which the first samples see few. Four first samples of all
// pixels that ask the same four passes would say where these happen to be bright.
TEST(Adaptive, CausticsAreUnbiased) {
  Scene scene = bare_scene(32);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = 4, scene.integrator.depth = 6;
  scene.integrator.caustics.photons = 60, scene.integrator.caustics.radius = 0.12;
  scene.camera.from = {0, 6, 0.01}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 40;
  scene.lights = {PointLight{{0, 1.5, 0}, {10, 10, 10}, true}};
  add_object(scene, PlaneShape{{0, 1, 0}, 0}, add_material(scene, diffuse({0.7f, 0.7f, 0.7f})));
  add_object(scene, SphereShape{{0, 1.5, 0}, 0.5}, add_material(scene, glass(1.5f)));
  expect_same_mean(scene, 40, 0.1, 64);
}

// The points of area lights are shared by pixels, too: here few of them shine through a slit.
TEST(Adaptive, PointsOfAreaLightsAreUnbiased) {
  Scene scene = bare_scene(32);
  scene.integrator.kind = IntegratorKind::whitted;
  scene.integrator.samples = 4, scene.integrator.depth = 1;
  scene.integrator.light_samples = 1, scene.integrator.penumbra_factor = 1;
  scene.camera.from = {0, 3, 0.01}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 40;
  const std::uint32_t white = add_material(scene, diffuse({1, 1, 1}));
  add_object(scene, PlaneShape{{0, 1, 0}, 0}, white);
  add_object(scene, BoxShape{{-9, 3.2, -9}, {2, 3.3, 9}}, white);
  add_object(scene, BoxShape{{2.1, 3.2, -9}, {9, 3.3, 9}}, white);
  add_object(scene, MeshShape{parallelogram({-3, 4, -3}, {6, 0, 0}, {0, 0, 6}), {}, false},
             add_material(scene, glowing({1, 1, 1})));
  expect_same_mean(scene, 60, 0.2, 256);
}

// The mean relative error over the picture is near the one that was asked for where the limit is not reached.
TEST(Adaptive, TheErrorIsAboutTheStatedOne) {
  Scene scene = hard_scene(4096);
  const Picture truth = run(scene).picture;
  for (const double error : {0.1, 0.05}) {
    scene.integrator.samples = 16;
    scene.integrator.error = error, scene.integrator.max_samples = 4096;
    const Picture p = run(scene).picture;
    double sum = 0, count = 0;
    for (std::uint32_t y = 0; y < 32; ++y)
      for (std::uint32_t x = 0; x < 32; ++x) {
        const double light = std::max<double>(value(truth, "G", x, y), kDarkestLight);
        const double e = (value(p, "G", x, y) - value(truth, "G", x, y)) / light;
        sum += e * e, ++count;
      }
    EXPECT_LT(std::sqrt(sum / count), 1.25 * error);
    EXPECT_GT(std::sqrt(sum / count), 0.1 * error);
  }
}

TEST(Adaptive, SamplesGoWhereNoiseIs) {
  Scene scene = bare_scene(64);
  scene.integrator.samples = 4;
  scene.integrator.error = 0.02, scene.integrator.max_samples = 128;
  scene.background = {0.5f, 0.5f, 0.5f};
  scene.camera.projection = Projection::orthographic;
  scene.camera.height = 4;
  add_object(scene, BoxShape{{0.01, -9, -1}, {9, 9, 1}}, add_material(scene, glowing({2, 2, 2})));
  const RenderResult result = run(scene);
  const PicturePlane* counts = result.picture.find("sampleCount.I");
  ASSERT_NE(counts, nullptr);
  EXPECT_EQ(id(result.picture, "sampleCount.I", 10, 10), 4u);
  EXPECT_EQ(id(result.picture, "sampleCount.I", 60, 10), 4u);
  EXPECT_GE(id(result.picture, "sampleCount.I", 33, 10), 32u);
  // Pixels at the edge are decided by their neighbours, so they keep their own samples out of it.
  std::uint64_t all = 0;
  for (const std::uint32_t n : counts->ids) all += n;
  EXPECT_LT(all, 64u * 64 * 20);
  EXPECT_EQ(run(bare_scene(4)).picture.find("sampleCount.I"), nullptr);
}

// What a pixel gets depends on the frame alone: not on threads, tiles, instruction sets or the crop.
TEST(Adaptive, PicturesHaveTheSameBits) {
  Scene scene = hard_scene(4);
  scene.integrator.error = 0.2, scene.integrator.max_samples = 64;
  for (const bool layers : {true, false}) {
    const auto with = [&](unsigned threads, Isa isa, std::uint32_t tile) {
      return run(scene,
                 [&](RenderOptions& o) {
                   o.threads = threads, o.isa = isa, o.tile_size = tile, o.data_layers = layers;
                 })
          .picture;
    };
    const Picture whole = with(1, Isa::scalar, 32);
    EXPECT_TRUE(same_bytes(whole, with(2, default_isa(), 5)));
    Scene cropped = scene;
    cropped.film.crop[0] = 0.25, cropped.film.crop[1] = 0.75, cropped.film.crop[2] = 0.5;
    const Picture part = run(cropped, [&](RenderOptions& o) { o.data_layers = layers; }).picture;
    for (std::uint32_t y = 0; y < part.height; ++y)
      for (std::uint32_t x = 0; x < part.width; ++x)
        ASSERT_EQ(color(part, x, y), color(whole, x + 8, y + 16)) << x << ' ' << y;
  }
}

// Adaptive sampling and motion together: each cycle of samples spans the shutter's time.
TEST(Adaptive, WorksWhileThingsMove) {
  Scene scene = bare_scene(16);
  scene.integrator.samples = 16;
  scene.integrator.error = 0.01, scene.integrator.max_samples = 1000;
  scene.camera.projection = Projection::orthographic;
  scene.camera.height = 4;
  add_object(scene, BoxShape{{-3, -9, -1}, {-2, 9, 1}}, add_material(scene, glowing({1, 1, 1})));
  scene.objects[0].motion =
      std::make_shared<const Motion>(Motion{{{{0, Affine()}, {1, Affine::translation({4, 0, 0})}}}});
  const Picture p = run(scene).picture;
  // A bar of width 1 passes the middle in a quarter of the time.
  EXPECT_NEAR(value(p, "R", 8, 8), 0.25, 0.03);
  EXPECT_EQ(id(p, "sampleCount.I", 8, 8), 992u);
}

}  // namespace
}  // namespace oktett::adaptive_test
