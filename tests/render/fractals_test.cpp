#include <gtest/gtest.h>

#include "tests/render/test_scenes.h"

namespace oktett::fractals_test {
namespace {

using namespace test;

Scene scene_of(const ExactForm& form) {
  Scene scene = bare_scene(48);
  scene.integrator.samples = 2;
  scene.camera.from = {2, 2, 5}, scene.camera.at = {0, 0, 0};
  scene.background = {0, 0, 1};
  scene.ambient_light = {0.2f, 0.2f, 0.2f};
  scene.lights = {PointLight{{5, 6, 7}, {1, 1, 1}, false}};
  Material plain = diffuse({0.8f, 0.8f, 0.8f});
  plain.ambient = 0.5f;
  add_object(scene, ExactShape{form}, add_material(scene, plain));
  return scene;
}

/// Fractals of more parts than any memory holds are rendered with light and shadow, to the same bits on every
/// instruction set and number of threads.
TEST(Fractals, DeepOnesRender) {
  for (const ExactForm& form : {ExactForm(SphereflakeShape{12}), ExactForm(MengerShape{10})}) {
    const Scene scene = scene_of(form);
    const RenderResult result = run(scene);
    const Picture& picture = result.picture;
    int covered = 0, lit = 0, dark = 0;
    for (std::uint32_t y = 0; y < 48; ++y)
      for (std::uint32_t x = 0; x < 48; ++x) {
        const Color c = color(picture, x, y);
        EXPECT_TRUE(std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z));
        if (c.x == 0) continue;
        ++covered, lit += c.x > 0.2f, dark += c.x < 0.1f;
      }
    EXPECT_GT(covered, 400);
    EXPECT_LT(covered, 48 * 48 - 400);
    EXPECT_GT(lit, 100);
    EXPECT_GT(dark, 20);
    for (const Isa isa : available_isas())
      EXPECT_TRUE(
          same_bytes(picture, run(scene, [&](RenderOptions& o) { o.isa = isa, o.threads = 1; }).picture));
  }
}

}  // namespace
}  // namespace oktett::fractals_test
