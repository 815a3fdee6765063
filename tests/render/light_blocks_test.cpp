/// \file Whole pictures by two ways of sampling the same light, compared block by block.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "tests/render/test_scenes.h"

namespace oktett::light_blocks_test {
namespace {

using namespace test;

/// Pictures of 40 x 25 blocks of this many pixels along an edge.
constexpr std::uint32_t kBlock = 4, kColumns = 40, kRows = 25, kBlocks = kColumns * kRows;
/// Pictures with different random numbers for each way.
constexpr int kRuns = 8;

/// A room of diffuse, glossy, rough metal and glass things, without lamps.
Scene dark_room() {
  Scene scene = bare_scene();
  scene.film.width = kBlock * kColumns, scene.film.height = kBlock * kRows;
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = 16, scene.integrator.depth = 4;
  scene.camera.from = {0, 1, 4}, scene.camera.at = {0, 0.8, 0}, scene.camera.fov = 40;
  const std::uint32_t white = add_material(scene, diffuse({0.7f, 0.7f, 0.7f}));
  const std::uint32_t red = add_material(scene, diffuse({0.7f, 0.2f, 0.1f}));
  Material glossy = diffuse({0.3f, 0.4f, 0.6f});
  glossy.specular = 0.3f, glossy.phong = 40;
  Material metal, rough_glass;
  metal.principled.emplace(), rough_glass.principled.emplace();
  metal.principled->parameters.metallic = 1, metal.principled->parameters.roughness = 0.3f;
  rough_glass.principled->parameters.transmission = 1, rough_glass.principled->parameters.roughness = 0.4f;
  rough_glass.principled->parameters.base_color = {1, 1, 1};
  add_object(scene, PlaneShape{{0, 1, 0}, 0}, white);
  add_object(scene, PlaneShape{{0, 0, 1}, -1.5}, red);
  add_object(scene, SphereShape{{-1, 0.5, 0}, 0.5}, add_material(scene, glossy));
  add_object(scene, SphereShape{{0.1, 0.5, -0.4}, 0.5}, add_material(scene, metal));
  add_object(scene, SphereShape{{1.1, 0.4, 0.4}, 0.4}, add_material(scene, rough_glass));
  return scene;
}

/// The room under a box that glows, which path tracing does not sample, or under the same as a mesh, whose
/// triangles it does.
Scene room_with_box(bool sampled) {
  Scene scene = dark_room();
  const std::uint32_t lamp = add_material(scene, glowing({3, 2.5f, 2}));
  const Vec3d lo{-0.8, 1.9, -0.8}, hi{0.8, 2.1, 0.8};
  if (!sampled) {
    add_object(scene, BoxShape{lo, hi}, lamp);
    return scene;
  }
  auto mesh = std::make_shared<TriangleMesh>();
  for (int i = 0; i < 8; ++i)
    mesh->positions.push_back(Vec3f(Vec3d{i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z}));
  for (const auto& [a, b, c, d] : {std::array{0u, 2u, 3u, 1u},
                                   {4u, 5u, 7u, 6u},
                                   {0u, 1u, 5u, 4u},
                                   {2u, 6u, 7u, 3u},
                                   {0u, 4u, 6u, 2u},
                                   {1u, 3u, 7u, 5u}})
    for (const std::uint32_t k : {a, b, c, a, c, d}) mesh->indices.push_back(k);
  add_object(scene, MeshShape{mesh, {}, false}, lamp);
  return scene;
}

/// The room with balls and disks that glow. Stretched by a hundredth of a percent they are not sampled.
Scene room_with_balls(bool sampled) {
  Scene scene = dark_room();
  const std::uint32_t lamp = add_material(scene, glowing({6, 5, 4}));
  const Affine stretched = sampled ? Affine{} : Affine::scaling({1, 1.0001, 1});
  for (const double x : {-0.7, 0.6}) {
    add_object(scene, SphereShape{{x, 1.8, 0.2}, 0.3}, lamp, stretched);
    add_object(scene, DiskShape{{x, 0.9, -1.4}, {0.2, 0.1, 1}, 0.3}, lamp, stretched);
  }
  return scene;
}

/// Mean and variance of the mean over the runs, for each block.
struct BlockMeans {
  std::vector<double> mean, variance;
};

BlockMeans block_means(Scene scene) {
  std::vector<double> sum(kBlocks), square(kBlocks);
  for (int run_number = 0; run_number < kRuns; ++run_number) {
    scene.integrator.seed = static_cast<std::uint32_t>(run_number);
    const Picture picture = run(scene, [](RenderOptions& o) { o.data_layers = false; }).picture;
    std::vector<double> block(kBlocks);
    for (std::uint32_t y = 0; y < picture.height; ++y)
      for (std::uint32_t x = 0; x < picture.width; ++x)
        block[y / kBlock * kColumns + x / kBlock] +=
            static_cast<double>(value(picture, "G", x, y)) / (kBlock * kBlock);
    for (std::size_t i = 0; i < kBlocks; ++i) sum[i] += block[i], square[i] += block[i] * block[i];
  }
  BlockMeans result;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    result.mean.push_back(sum[i] / kRuns);
    result.variance.push_back((square[i] - sum[i] * sum[i] / kRuns) / (kRuns - 1) / kRuns);
  }
  return result;
}

/// Expects the differences between pictures with and without light samples to be those of chance.
void expect_same_blocks(const Scene& sampled, const Scene& unsampled) {
  const BlockMeans with = block_means(sampled), without = block_means(unsampled);
  const auto noise = [](const BlockMeans& m) {
    return std::accumulate(m.variance.begin(), m.variance.end(), 0.0);
  };
  EXPECT_GT(noise(without), 2 * noise(with));
  double sum = 0, square = 0;
  int compared = 0, far_off = 0;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    const double variance = with.variance[i] + without.variance[i];
    if (variance == 0) {  // The lamp itself, which both see as it is.
      EXPECT_EQ(with.mean[i], without.mean[i]) << i;
      continue;
    }
    const double t = (with.mean[i] - without.mean[i]) / std::sqrt(variance);
    ++compared, sum += t, square += t * t;
    far_off += std::abs(t) > 5 ? 1 : 0;
  }
  ASSERT_GT(compared, 900);
  // t has at least kRuns - 1 degrees of freedom, so its variance is between 1 and 7/5.
  EXPECT_LT(std::abs(sum / std::sqrt(compared)), 4);
  EXPECT_GT(square / compared, 0.85);
  EXPECT_LT(square / compared, 1.6);
  EXPECT_LE(far_off, 5);
}

// Multiple importance sampling and brute force give the same light in each of 1000 blocks.
TEST(LightBlocks, SampledAndUnsampledLampsAgreeInAThousandBlocks) {
  expect_same_blocks(room_with_box(true), room_with_box(false));
}

TEST(LightBlocks, SampledAndUnsampledBallsAndDisksAgreeInAThousandBlocks) {
  expect_same_blocks(room_with_balls(true), room_with_balls(false));
}

}  // namespace
}  // namespace oktett::light_blocks_test
