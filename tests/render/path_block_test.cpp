#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "render/transport/integrators.h"
#include "render/transport/path_block.h"
#include "render/transport/wavefront.h"
#include "tests/render/test_scenes.h"

namespace oktett {
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

/// The colours of the samples of all pixels. `alone`: hits are shaded one by one.
std::vector<Color> traced(const Scene& scene, Isa isa, bool alone) {
  const World world = build_world(scene);
  const SceneLights lights(scene, world);
  RenderContext context = make_context(scene, world, lights, nullptr, isa);
  context.data_layers = false;
  if (alone) {
    std::vector<PathSurface> surfaces = *context.path_surfaces;
    for (PathSurface& s : surfaces) s.alone = true;
    context.path_surfaces = std::make_shared<const std::vector<PathSurface>>(std::move(surfaces));
  }
  std::vector<WavefrontPixel> pixels;
  for (std::uint32_t i = 0; i < scene.film.width * scene.film.height; ++i)
    pixels.push_back({i, i % scene.film.width, i / scene.film.width});
  Wavefront wavefront;
  start_wavefront(context, pixels, 0, scene.integrator.samples, wavefront);
  EXPECT_TRUE(trace_wavefront(context, wavefront));
  std::vector<Color> colors;
  for (std::size_t i = 0; i < wavefront.samples.size(); ++i) colors.push_back(wavefront.samples.color[i]);
  // Lanes are counted by bounce.
  EXPECT_EQ(wavefront.counts.bounces[0].rays, pixels.size() * scene.integrator.samples);
  EXPECT_EQ(wavefront.counts.bounces[0].shaded > 0, !alone);
  for (const BounceReport& b : wavefront.counts.bounces) EXPECT_LE(b.shaded, b.lanes);
  return colors;
}

// Hits that are shaded in lanes get the bits of hits that are shaded alone, in each instruction set.
TEST(PathBlock, ShadesLikeSingleHits) {
  const Scene scene = crowded_room();
  const std::vector<Color> alone = traced(scene, Isa::scalar, true);
  float brightest = 0;
  for (const Color& c : alone) brightest = std::max(brightest, max_component(c));
  EXPECT_GT(brightest, 0.1f);
  for (const Isa isa : available_isas()) {
    const std::vector<Color> together = traced(scene, isa, false);
    ASSERT_EQ(together.size(), alone.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < alone.size(); ++i) different += !(together[i] == alone[i]);
    EXPECT_EQ(different, 0u) << to_string(isa);
  }
}

}  // namespace
}  // namespace oktett
