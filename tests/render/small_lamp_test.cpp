/// \file A room with a small bright lamp: how much noise few samples leave.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/render/test_scenes.h"

namespace oktett::small_lamp_test {
namespace {

using namespace test;

/// Pictures of 8 x 6 blocks of this many pixels along an edge.
constexpr std::uint32_t kBlock = 16, kColumns = 8, kRows = 6, kBlocks = kColumns * kRows;
constexpr int kRuns = 8;

/// A closed room of 4 x 3 x 4, with a box and two balls in it, seen from one end and lit by a ball of radius
/// 0.05 below the ceiling.
Scene room() {
  Scene scene = bare_scene();
  scene.film.width = kBlock * kColumns, scene.film.height = kBlock * kRows;
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = 64, scene.integrator.depth = 8;
  scene.camera.from = {0, 1.5, 1.9}, scene.camera.at = {0, 1.3, -2}, scene.camera.fov = 60;
  const std::uint32_t white = add_material(scene, diffuse({0.7f, 0.7f, 0.7f}));
  add_object(scene, PlaneShape{{0, 1, 0}, 0}, white);
  add_object(scene, PlaneShape{{0, -1, 0}, -3}, white);
  add_object(scene, PlaneShape{{0, 0, 1}, -2}, white);
  add_object(scene, PlaneShape{{0, 0, -1}, -2}, white);
  add_object(scene, PlaneShape{{1, 0, 0}, -2}, add_material(scene, diffuse({0.7f, 0.2f, 0.2f})));
  add_object(scene, PlaneShape{{-1, 0, 0}, -2}, add_material(scene, diffuse({0.2f, 0.6f, 0.3f})));
  add_object(scene, BoxShape{{-1.4, 0, -1.5}, {-0.5, 1.2, -0.7}}, white);
  add_object(scene, SphereShape{{0.6, 0.5, -0.8}, 0.5}, white);
  Material metal;
  metal.principled.emplace();
  metal.principled->parameters.metallic = 1, metal.principled->parameters.roughness = 0.35f;
  add_object(scene, SphereShape{{1.3, 0.35, 0}, 0.35}, add_material(scene, metal));
  add_object(scene, SphereShape{{0.3, 2.6, -0.4}, 0.05}, add_material(scene, glowing({300, 280, 250})));
  return scene;
}

// The standard deviation of the mean of each block, relative to that mean, in each channel.
TEST(SmallLamp, BlocksOfARoomAreKnownWithinTwoPercent) {
  Scene scene = room();
  std::vector<double> sum(3 * kBlocks), square(3 * kBlocks);
  for (int n = 0; n < kRuns; ++n) {
    scene.integrator.seed = static_cast<std::uint32_t>(n);
    const Picture picture = run(scene, [](RenderOptions& o) { o.data_layers = false; }).picture;
    std::vector<double> block(3 * kBlocks);
    for (std::uint32_t y = 0; y < picture.height; ++y)
      for (std::uint32_t x = 0; x < picture.width; ++x)
        for (std::uint32_t c = 0; c < 3; ++c)
          block[3 * (y / kBlock * kColumns + x / kBlock) + c] +=
              static_cast<double>(color(picture, x, y)[static_cast<int>(c)]) / (kBlock * kBlock);
    for (std::size_t i = 0; i < 3 * kBlocks; ++i) sum[i] += block[i], square[i] += block[i] * block[i];
  }
  double worst = 0, squares = 0;
  for (std::size_t i = 0; i < 3 * kBlocks; ++i) {
    const double mean = sum[i] / kRuns, variance = (square[i] / kRuns - mean * mean) * kRuns / (kRuns - 1);
    const double error = std::sqrt(std::max(0.0, variance)) / mean;
    worst = std::max(worst, error), squares += error * error / (3 * kBlocks);
  }
  RecordProperty("worst_percent", std::to_string(100 * worst));
  RecordProperty("rms_percent", std::to_string(100 * std::sqrt(squares)));
  // With these seeds 1.55 % and 0.73 %, a quarter below the bounds: so much is a deviation that is estimated
  // from eight runs off by, if another order of random numbers takes the place of this one.
  EXPECT_LT(worst, 0.02);
  EXPECT_LT(std::sqrt(squares), 0.01);
}

}  // namespace
}  // namespace oktett::small_lamp_test
