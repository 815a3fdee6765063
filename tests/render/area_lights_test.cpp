/// \file Lamps of some size in Whitted's model: closed forms, path tracing as the oracle, bits.

#include "render/area_lights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "render/context.h"
#include "render/geometry.h"
#include "tests/render/test_scenes.h"

namespace oktett::area_lights_test {
namespace {

using namespace test;

/// A white floor at z = 0 of which the camera sees the point (0, 0), lit by what is added.
Scene floor_scene(std::uint32_t light_samples) {
  Scene scene = bare_scene(1);
  scene.camera.from = {3, 0, 2}, scene.camera.at = {0, 0, 0}, scene.camera.up = {0, 0, 1};
  scene.camera.fov = 1e-3;
  scene.integrator.light_samples = light_samples;
  add_object(scene, PlaneShape{{0, 0, 1}, 0}, add_material(scene, diffuse({1, 1, 1})));
  return scene;
}

float shown(const Scene& scene) { return value(run(scene).picture, "G", 0, 0); }

PolygonShape square(double half, double z) {
  return {{{-half, -half, z}, {-half, half, z}, {half, half, z}, {half, -half, z}}};
}

// What a white diffuse surface shows of a lamp is its radiance times its form factor.
TEST(AreaLights, LampsLightByTheirFormFactors) {
  const Material lamp = glowing({3, 5, 7});
  {
    Scene scene = floor_scene(1024);
    add_object(scene, DiskShape{{0, 0, 2}, {0, 0, 1}, 1.5}, add_material(scene, lamp));
    EXPECT_NEAR(shown(scene), 5 * 1.5 * 1.5 / (1.5 * 1.5 + 2 * 2), 0.01);
  }
  {
    Scene scene = floor_scene(1024);
    add_object(scene, SphereShape{{1, 0, 2}, 0.5}, add_material(scene, lamp));
    const double square = 5;
    EXPECT_NEAR(shown(scene), 5 * (0.5 * 0.5 / square) * (2 / std::sqrt(square)), 0.01);
  }
  // Lambert's formula for a square above the point.
  const double edge = 0.7 / std::sqrt(0.7 * 0.7 + 4);
  const double factor = 4 / std::numbers::pi * edge * std::atan(edge);
  {
    Scene scene = floor_scene(1024);
    add_object(scene, square(0.7, 2), add_material(scene, lamp));
    EXPECT_NEAR(shown(scene), 5 * factor, 0.01);
  }
  {
    Scene scene = floor_scene(1024);
    TriangleMesh mesh;
    for (const Vec3f& corner : {Vec3f{-0.7f, -0.7f, 2}, {-0.7f, 0.7f, 2}, {0.7f, 0.7f, 2}, {0.7f, -0.7f, 2}})
      mesh.positions.push_back(corner);
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(i);
    MeshShape shape;
    shape.mesh = std::make_shared<const TriangleMesh>(std::move(mesh));
    add_object(scene, std::move(shape), add_material(scene, lamp));
    EXPECT_NEAR(shown(scene), 5 * factor, 0.02);
  }
}

// A plate that ends above the point hides half of the lamp behind it.
TEST(AreaLights, HalfALampHasHalfTheLight) {
  Scene scene = floor_scene(1024);
  const std::uint32_t lamp = add_material(scene, glowing({1, 1, 1}));
  add_object(scene, DiskShape{{0, 0, 2}, {0, 0, 1}, 0.5}, lamp);
  const float open = shown(scene);
  add_object(scene, PolygonShape{{{0, -9, 1}, {9, -9, 1}, {9, 9, 1}, {0, 9, 1}}}, 0);
  scene.camera.from = {-3, 0, 2};
  EXPECT_NEAR(shown(scene), open / 2, 0.005 * open);
}

// Where a lamp is half hidden, a hit asks as many points as if `light_samples` were greater by the factor:
// the same points, so the light is the same. In full light and in full shadow it asks no more.
TEST(AreaLights, HitsInPenumbrasAskMorePoints) {
  const auto light = [](std::uint32_t samples, std::uint32_t factor, double edge, std::uint64_t& shadow_rays,
                        bool data_layers) {
    Scene scene = floor_scene(samples);
    scene.integrator.penumbra_factor = factor;
    add_object(scene, DiskShape{{0, 0, 2}, {0, 0, 1}, 0.5}, add_material(scene, glowing({1, 1, 1})));
    add_object(scene, PolygonShape{{{edge, -9, 1}, {9, -9, 1}, {9, 9, 1}, {edge, 9, 1}}}, 0);
    scene.camera.from = {-3, 0, 2};
    const RenderResult result = run(scene, [&](RenderOptions& o) { o.data_layers = data_layers; });
    shadow_rays = result.report.shadow_rays;
    return value(result.picture, "G", 0, 0);
  };
  for (const bool data_layers : {false, true})
    for (const std::uint32_t factor : {1u, 2u, 4u, 8u, 16u}) {
      std::uint64_t few = 0, many = 0;
      const float half = light(16, factor, 0.03, few, data_layers);
      EXPECT_NEAR(half, light(16 * factor, 1, 0.03, many, data_layers), 1e-5f * half) << factor;
      EXPECT_EQ(few, many) << factor;
      light(16, factor, 2, few, data_layers), light(16, 1, 2, many, data_layers);
      EXPECT_EQ(few, many) << factor;
      EXPECT_EQ(light(16, factor, -1, few, data_layers), 0.0f);
      light(16, 1, -1, many, data_layers);
      EXPECT_EQ(few, many) << factor;
    }
}

/// Several lamps of each kind over balls and a mirror.
Scene lamps_scene(std::uint32_t size) {
  Scene scene = bare_scene(size);
  scene.camera.from = {0, -7, 4}, scene.camera.at = {0, -0.5, 0}, scene.camera.up = {0, 0, 1};
  scene.camera.fov = 30;  // the lamps themselves are not in the picture
  add_object(scene, PlaneShape{{0, 0, 1}, 0}, add_material(scene, diffuse({0.8f, 0.7f, 0.6f})));
  for (int i = 0; i < 4; ++i) add_object(scene, SphereShape{{i - 1.5, 0.3 * i, 0.4}, 0.4}, 0);
  Material front = glowing({4, 2, 1});
  front.emits_behind = false;
  add_object(scene, DiskShape{{-2, 1, 2.6}, normalize(Vec3d{1, 0, -1}), 0.5}, add_material(scene, front));
  add_object(scene, square(0.5, 3), add_material(scene, glowing({1, 2, 4})));
  add_object(scene, SphereShape{{2.5, -1, 1}, 0.25}, add_material(scene, glowing({3, 3, 3})));
  return scene;
}

// Path tracing without bounces sees the same light; it samples directions where these are points.
TEST(AreaLights, TheMeanIsThatOfPathTracing) {
  Scene scene = lamps_scene(32);
  scene.integrator.depth = 0;
  scene.integrator.samples = 32, scene.integrator.light_samples = 64;
  const Picture ours = run(scene).picture;
  scene.integrator.kind = IntegratorKind::path, scene.integrator.samples = 1024;
  const Picture theirs = run(scene).picture;
  for (const char* plane : {"R", "G", "B"})
    for (std::uint32_t y0 = 0; y0 < 32; y0 += 8)
      for (std::uint32_t x0 = 0; x0 < 32; x0 += 8) {
        double a = 0, b = 0;
        for (std::uint32_t y = y0; y < y0 + 8; ++y)
          for (std::uint32_t x = x0; x < x0 + 8; ++x)
            a += double{value(ours, plane, x, y)}, b += double{value(theirs, plane, x, y)};
        EXPECT_NEAR(a, b, 0.02 * b + 0.01) << plane << ' ' << x0 << ' ' << y0;
      }
}

TEST(AreaLights, PicturesHaveTheSameBits) {
  Scene scene = lamps_scene(40);
  scene.objects[2].material = add_material(scene, mirror());
  scene.objects[3].material = add_material(scene, glass(1.5f));
  scene.lights = {PointLight{{3, -4, 5}, {0.5f, 0.5f, 0.5f}, false}};
  for (const std::uint32_t samples : {1u, 3u, 20u}) {
    scene.integrator.samples = samples, scene.integrator.light_samples = 5;
    const auto bare = [](RenderOptions& o) { o.data_layers = false; };
    const Picture one = run(scene, bare).picture;
    for (const Isa isa : available_isas())
      for (const std::uint32_t tile : {7u, 64u}) {
        const Picture other = run(scene, [&](RenderOptions& o) {
                                o.data_layers = false, o.isa = isa, o.tile_size = tile, o.threads = 3;
                              }).picture;
        EXPECT_TRUE(same_bytes(one, other)) << to_string(isa) << ' ' << tile;
      }
    // With data layers hits are shaded one by one.
    const Picture layers = run(scene).picture;
    for (const char* plane : {"R", "G", "B"})
      for (std::uint32_t y = 0; y < 40; ++y)
        for (std::uint32_t x = 0; x < 40; ++x)
          EXPECT_EQ(value(one, plane, x, y), value(layers, plane, x, y)) << samples;
  }
}

// Each pattern has a point in each cell of a grid, and all patterns have one in each cell of a finer grid.
TEST(AreaLights, PointsAreSpreadEvenly) {
  Scene scene = bare_scene();
  add_object(scene, PolygonShape{{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}},
             add_material(scene, glowing({1, 1, 1})));
  scene.integrator.light_samples = 16;
  const World world = build_world(scene, {});
  const SceneLights lights(scene, world);
  const AreaLights area = area_lights(lights, nullptr, scene.integrator);
  ASSERT_EQ(area.samples, 16u);
  ASSERT_EQ(area.patterns, 16u);
  std::set<std::pair<int, int>> fine;
  for (std::size_t pattern = 0; pattern < 16; ++pattern) {
    std::set<std::pair<int, int>> coarse;
    for (std::size_t k = 0; k < 16; ++k) {
      const LightSource& point = area.points[pattern * 16 + k];
      const auto cell = [&](float x, int n) { return static_cast<int>(x * static_cast<float>(n)); };
      coarse.insert({cell(point.place.x, 4), cell(point.place.y, 4)});
      fine.insert({cell(point.place.x, 16), cell(point.place.y, 16)});
    }
    EXPECT_EQ(coarse.size(), 16u);
  }
  EXPECT_EQ(fine.size(), 256u);
  // The pixels of a block have all patterns, and so have the samples of a pixel.
  std::set<std::uint32_t> of_block, of_pixel;
  for (std::uint32_t k = 0; k < 16; ++k)
    of_block.insert(area.pattern(8 + k % 4, 12 + k / 4, 3)), of_pixel.insert(area.pattern(5, 6, k));
  EXPECT_EQ(of_block.size(), 16u);
  EXPECT_EQ(of_pixel.size(), 16u);
}

TEST(AreaLights, GlowingSurfacesLightNothingUnlessAsked) {
  Scene scene = floor_scene(0);
  add_object(scene, DiskShape{{0, 0, 2}, {0, 0, 1}, 1.5}, add_material(scene, glowing({1, 1, 1})));
  EXPECT_EQ(shown(scene), 0);
}

// Lamps without area, light or a finite number give nothing, and no NaN.
TEST(AreaLights, OddLampsAreLeftOut) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const Color& color :
       {Color{kNan, 1, 1}, Color{1e38f, 1e38f, 1e38f}, Color{-1, -1, -1}, Color{0, 0, 0}}) {
    Scene scene = floor_scene(3);
    add_object(scene, DiskShape{{0, 0, 2}, {0, 0, 1}, 0}, add_material(scene, glowing({1, 1, 1})));
    add_object(scene, square(1e30, 2), add_material(scene, glowing(color)));
    const World world = build_world(scene, {});
    const AreaLights area = area_lights(SceneLights(scene, world), nullptr, scene.integrator);
    for (const LightSource& light : area.points)
      EXPECT_TRUE(is_finite(light.place) && is_finite(light.color));
  }
  // Shadow rays that end on a lamp do not meet it, however it is turned.
  for (int turn = 0; turn < 20; ++turn) {
    Scene scene = floor_scene(64);
    const double x = std::cos(turn), y = std::sin(turn);
    add_object(scene, DiskShape{{20 * x, 20 * y, 30}, normalize(Vec3d{x, y, 1.3}), 2},
               add_material(scene, glowing({100, 100, 100})));
    const double distance = std::sqrt(1300.0);
    const double cosine = (20 * 1 + 30 * 1.3) / std::sqrt(1 + 1.3 * 1.3) / distance;
    const double expected = 100 * 4 * cosine * (30 / distance) / (distance * distance);
    EXPECT_NEAR(shown(scene), expected, 0.01 * expected) << turn;
  }
}

}  // namespace
}  // namespace oktett::area_lights_test
