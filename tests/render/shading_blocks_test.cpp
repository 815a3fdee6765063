#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "render/transport/integrators.h"
#include "render/transport/wavefront.h"
#include "tests/render/test_scenes.h"

namespace oktett::shading_blocks_test {
namespace {

using namespace test;

/// A closed room with all kinds of materials and lights.
Scene crowded_room() {
  Scene scene = bare_scene(24);
  scene.integrator.kind = IntegratorKind::path, scene.integrator.samples = 4, scene.integrator.depth = 6;
  scene.camera.from = {0.2, 0.3, 3.5};
  Material shiny = diffuse({0.7f, 0.5f, 0.2f});
  shiny.specular = 0.4f, shiny.phong = 20.5f, shiny.reflection = 0.2f;
  Material lamp = diffuse({0.2f, 0.2f, 0.2f});
  lamp.emission = {3, 4, 5}, lamp.emits_behind = false;
  Material metal, frosted, layered;
  metal.principled.emplace(), frosted.principled.emplace(), layered.principled.emplace();
  metal.principled->parameters.metallic = 1, metal.principled->parameters.roughness = 0.3f;
  frosted.principled->parameters.transmission = 1, frosted.principled->parameters.roughness = 0.25f;
  layered.principled->parameters.coat = 0.7f, layered.principled->parameters.sheen = 0.5f;
  const Material materials[] = {shiny, glass(1.5f), mirror(), lamp, metal, frosted, layered};
  for (std::size_t i = 0; i < std::size(materials); ++i) {
    const std::uint32_t m = add_material(scene, materials[i]);
    for (int k = 0; k < 3; ++k) {
      const auto number = static_cast<double>(3 * i + k);
      add_object(scene, SphereShape{{-1.2 + 0.4 * i, -0.8 + 0.6 * k, 0.3 * std::sin(number)}, 0.25}, m);
    }
  }
  add_object(scene, PlaneShape{{0, 1, 0}, -1.1}, add_material(scene, diffuse({0.5f, 0.6f, 0.7f})));
  scene.lights.push_back(SkyLight{});
  PointLight point;
  point.position = {0, 3, 2};
  scene.lights.push_back(point);
  scene.lights_given = true;
  return scene;
}

/// The same room with lamps of all kinds but the sky: triangles, disks, rectangles, points and spots, one
/// with a profile; with a sun alone, or with two, which overlap.
Scene room_of_lamps(bool two_suns) {
  Scene scene = crowded_room();
  Material lamp = glowing({30, 20, 10});
  const std::uint32_t glows = add_material(scene, lamp);
  lamp.emits_behind = false;
  const std::uint32_t front = add_material(scene, lamp);
  auto mesh = std::make_shared<TriangleMesh>();
  for (const Vec3f& p : {Vec3f{-2, 2, 1}, {-1.8f, 2.1f, 1}, {-2, 2.1f, 1.3f}, {-2.3f, 1.8f, 1.1f}})
    mesh->positions.push_back(p);
  for (const std::uint32_t k : {0, 1, 2, 0, 2, 3}) mesh->indices.push_back(k);
  add_object(scene, MeshShape{mesh, {}, false, TriangleTest::watertight}, glows);
  add_object(scene, DiskShape{{1, 2, 1}, {-0.3, -1, 0}, 0.2}, front);
  // So close to a disk that directions are chosen within a circle.
  add_object(scene, DiskShape{{0, -1.09, 0.5}, {0, -1, 0}, 0.5}, glows);
  add_object(scene, PolygonShape{{{0, 2, 1}, {0.3, 2, 1}, {0.3, 2, 1.2}, {0, 2, 1.2}}}, glows);
  LightProfile profile;
  profile.vertical = {0, 60, 180}, profile.horizontal = {0}, profile.values = {1, 0.5f, 0.1f};
  scene.lights = {PointLight{{1, 2, 2}, {1, 1, 1}, true}, PointLight{{-1, 2, 2}, {0.5f, 0.5f, 0.5f}, false},
                  SpotLight{{0, 2, 2}, {0, -1, -0.5}, {9, 8, 7}, 20, 50},
                  DirectionalLight{{1, -2, -1}, {0.5f, 0.5f, 0.4f}, 4}};
  scene.lights.push_back(
      PointLight{{0.5, 2, 2}, {2, 1, 1}, true, std::make_shared<const LightProfile>(profile), 30});
  if (two_suns) scene.lights.push_back(DirectionalLight{{1.02, -2, -1}, {0.5f, 0.3f, 0.4f}, 6});
  return scene;
}

/// The same for Whitted's model. With `varied`, glass and a pattern make some hits of most blocks wait for
/// code that shades them alone.
Scene crowded_whitted(bool varied) {
  Scene scene = crowded_room();
  scene.integrator.kind = IntegratorKind::whitted;
  scene.lights.erase(scene.lights.begin());
  scene.ambient_light = {0.2f, 0.3f, 0.4f};
  PointLight other;
  other.position = {-2, 2, 3};
  scene.lights.push_back(other);
  if (varied) {
    Texture checker;
    checker.pattern = PatternTexture{};
    scene.textures.push_back(checker);
    scene.materials.back().color_texture = 0, scene.materials[0].opacity = 0.5f;
  } else {
    for (Material& m : scene.materials) m.transparency = 0, m.reflection = 0.5f;
  }
  return scene;
}

SampleBatch traced(const Scene& scene, Isa isa, bool layers, bool one_by_one) {
  const World world = build_world(scene);
  const SceneLights lights(scene, world);
  RenderContext context = make_context(scene, world, lights, nullptr, isa);
  context.data_layers = layers, context.one_by_one = one_by_one;
  std::vector<WavefrontPixel> pixels;
  for (std::uint32_t i = 0; i < scene.film.width * scene.film.height; ++i)
    pixels.push_back({i, i % scene.film.width, i / scene.film.width});
  Wavefront wavefront;
  start_wavefront(context, pixels, 0, scene.integrator.samples, wavefront);
  EXPECT_TRUE(trace_wavefront(context, wavefront));
  // Lanes are counted by bounce.
  EXPECT_EQ(wavefront.counts.bounces[0].rays, pixels.size() * scene.integrator.samples);
  EXPECT_EQ(wavefront.counts.bounces[0].shaded > 0, !one_by_one);
  for (const BounceReport& b : wavefront.counts.bounces) EXPECT_LE(b.shaded, b.lanes);
  return std::move(wavefront.samples);
}

bool same(const FirstHit& a, const FirstHit& b) {
  if (a.found != b.found || a.primitive != b.primitive || a.object != b.object) return false;
  return !a.found ||
         (a.depth == b.depth && a.normal == b.normal && a.position == b.position && a.albedo == b.albedo &&
          a.uv.x == b.uv.x && a.uv.y == b.uv.y && a.material == b.material);
}

/// Hits that are shaded in lanes must get the bits of hits that are shaded alone, in each instruction set.
void expect_same_in_blocks(const Scene& scene) {
  const SampleBatch alone = traced(scene, Isa::scalar, true, true);
  float brightest = 0;
  for (std::size_t i = 0; i < alone.size(); ++i)
    brightest = std::max(brightest, max_component(alone.color[i]));
  EXPECT_GT(brightest, 0.1f);
  for (const bool layers : {false, true})
    for (const Isa isa : available_isas()) {
      const SampleBatch together = traced(scene, isa, layers, false);
      ASSERT_EQ(together.size(), alone.size());
      std::size_t colors = 0, alphas = 0, firsts = 0;
      for (std::size_t i = 0; i < alone.size(); ++i) {
        colors += !(together.color[i] == alone.color[i]), alphas += together.alpha[i] != alone.alpha[i];
        firsts += layers && !same(together.first[i], alone.first[i]);
      }
      EXPECT_EQ(colors, 0u) << to_string(isa) << ", data layers: " << layers;
      EXPECT_EQ(alphas, 0u) << to_string(isa) << ", data layers: " << layers;
      EXPECT_EQ(firsts, 0u) << to_string(isa);
    }
}

TEST(ShadingBlocks, PathsAreThoseOfSingleHits) { expect_same_in_blocks(crowded_room()); }

TEST(ShadingBlocks, LightOfAllLampsIsThatOfSingleHits) {
  expect_same_in_blocks(room_of_lamps(false));
  expect_same_in_blocks(room_of_lamps(true));
}

TEST(ShadingBlocks, WhittedIsThatOfSingleHits) {
  expect_same_in_blocks(crowded_whitted(false));
  expect_same_in_blocks(crowded_whitted(true));
}

}  // namespace
}  // namespace oktett::shading_blocks_test
