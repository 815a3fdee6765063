/// \file Hits shaded in lanes have the bits of hits shaded alone. What the values should be is tested where
/// the oracle is: BsdfFurnace and PrincipledSets integrate materials, LightTransport compares whole paths.

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
  Material metal, frosted, faint, layered;
  for (Material* m : {&metal, &frosted, &faint, &layered}) m->principled.emplace();
  metal.principled->parameters.metallic = 1, metal.principled->parameters.roughness = 0.3f;
  frosted.principled->parameters.transmission = 1, frosted.principled->parameters.roughness = 0.25f;
  faint.principled->parameters.transmission = 0.5f, faint.principled->parameters.ior = 1.005f;
  layered.principled->parameters.coat = 0.7f, layered.principled->parameters.sheen = 0.5f;
  const Material materials[] = {shiny, glass(1.5f), mirror(), lamp, metal, frosted, faint, layered};
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
  EXPECT_EQ(wavefront.counts.bounces[0].rays, pixels.size() * scene.integrator.samples);
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

/// How many hits are shaded at once. Paths compute in double, of which fewer fit into registers.
std::size_t width_of(IntegratorKind kind, Isa isa) {
  if (isa == Isa::scalar) return 1;
  if (kind == IntegratorKind::path) return isa == Isa::sse42 || isa == Isa::neon ? 4 : 8;
  return isa == Isa::avx512 ? 16 : 8;
}

/// Lanes that hits take which are shaded together.
std::size_t lanes_for(std::size_t hits, IntegratorKind kind, Isa isa) {
  std::size_t lanes = 0;
  while (lanes < hits) lanes += width_of(kind, isa);
  return lanes;
}

/// `columns` x 7 pixels of one sample: an even mirror fills the picture, and reflects a white wall behind
/// the camera.
Scene mirrored_wall(std::uint32_t columns, IntegratorKind kind) {
  Scene scene = bare_scene();
  scene.film.width = columns, scene.film.height = 7;
  scene.integrator.kind = kind, scene.integrator.depth = 1;
  add_object(scene, PlaneShape{{0, 0, 1}, 0}, add_material(scene, mirror()));
  add_object(scene, PlaneShape{{0, 0, -1}, -9}, add_material(scene, diffuse({1, 1, 1})));
  PointLight light;
  light.position = {0, 0, 3};
  scene.lights.push_back(light);
  return scene;
}

// Every ray of a bounce hits the same surface. Hits are shaded in blocks of 64, whose last lanes are empty
// where 64 does not divide the number of hits.
TEST(ShadingBlocks, LanesOfEachBounceAreCounted) {
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::whitted})
    for (const Isa isa : available_isas())
      for (const std::uint32_t columns : {1u, 9u, 15u, 32u, 64u}) {
        const std::size_t hits = 7 * columns, lanes = hits / 64 * 64 + lanes_for(hits % 64, kind, isa);
        const RenderReport report = run(mirrored_wall(columns, kind), [&](RenderOptions& o) {
                                      o.isa = isa, o.tile_size = 64;
                                    }).report;
        ASSERT_GE(report.bounces.size(), 2u);
        for (std::size_t bounce = 0; bounce < 2; ++bounce) {
          EXPECT_EQ(report.bounces[bounce].rays, hits);
          EXPECT_EQ(report.bounces[bounce].shaded, hits) << to_string(isa) << ", " << columns;
          EXPECT_EQ(report.bounces[bounce].lanes, lanes) << to_string(isa) << ", " << columns;
        }
      }
}

// Of two surfaces in one picture, paths shade the hits of each together.
TEST(ShadingBlocks, LanesOfPathsAreThoseOfEachSurface) {
  for (const Isa isa : available_isas())
    for (std::uint32_t left = 1; left < 8; ++left) {
      Scene scene = mirrored_wall(8, IntegratorKind::path);
      scene.camera.projection = Projection::orthographic, scene.camera.height = 7;
      // The box covers so many columns.
      add_object(scene, BoxShape{{-9, -9, -1}, {-4 + double(left), 9, 1}},
                 add_material(scene, diffuse({0, 0, 0})));
      const RenderReport report = run(scene, [&](RenderOptions& o) { o.isa = isa; }).report;
      const std::size_t boxed = 7 * left, others = 7 * (8 - left);
      EXPECT_EQ(report.bounces[0].shaded, boxed + others);
      EXPECT_EQ(report.bounces[0].lanes,
                lanes_for(boxed, scene.integrator.kind, isa) + lanes_for(others, scene.integrator.kind, isa))
          << to_string(isa) << ", " << left;
    }
}

}  // namespace
}  // namespace oktett::shading_blocks_test
