#include <gtest/gtest.h>

#include <cmath>

#include "tests/render/test_scenes.h"

namespace oktett::transparency_test {
namespace {

using namespace test;

/// Looks through a slab or ball at a board of glowing stripes far behind it.
Scene striped_background(std::uint32_t size) {
  Scene scene = bare_scene(size);
  scene.integrator.depth = 10;
  const std::uint32_t a = add_material(scene, glowing({1, 0.5f, 0.25f})),
                      b = add_material(scene, glowing({0, 0.1f, 1}));
  for (int i = -10; i < 10; ++i)
    add_object(scene, BoxShape{{0.5 * i, -10, -4}, {0.5 * i + 0.5, 10, -3}}, i % 2 == 0 ? a : b);
  return scene;
}

TEST(Transparency, GlassOfIndexOneIsInvisible) {
  Scene scene = striped_background(40);
  const Picture without = run(scene).picture;
  const std::uint32_t material = add_material(scene, glass(1));
  for (int kind = 0; kind < 2; ++kind) {
    Scene with = scene;
    if (kind == 0) add_object(with, SphereShape{{0.1, 0, 0}, 1}, material);
    if (kind == 1) add_object(with, MeshShape{sphere_mesh(20), {}, true, TriangleTest::watertight}, material);
    const Picture p = run(with).picture;
    int different = 0;
    for (std::uint32_t y = 0; y < p.height; ++y)
      for (std::uint32_t x = 0; x < p.width; ++x)
        if (length(color(p, x, y) - color(without, x, y)) > 1e-5f) ++different;
    EXPECT_EQ(different, 0) << kind;
  }
}

TEST(Transparency, EachSurfaceTintsTheLight) {
  Scene scene = bare_scene(9);
  scene.background = {1, 1, 1};
  Material m = glass(1);
  m.color = {0.5f, 1, 0.25f};
  m.transparency = 0.8f;
  add_object(scene, BoxShape{}, add_material(scene, m));
  const Color c = color(run(scene).picture, 4, 4);
  EXPECT_NEAR(length(c - Color{0.4f * 0.4f, 0.64f, 0.2f * 0.2f}), 0, 1e-6f);
}

TEST(Transparency, SlabReflectsAndTransmitsByFresnel) {
  // Head-on through a slab of glass: T = (1-R)^2 sum of R^2k, all light not transmitted is reflected.
  Scene scene = bare_scene(1);
  scene.integrator.depth = 20;
  add_object(scene, BoxShape{{-9, -9, -1}, {9, 9, 1}}, add_material(scene, glass(1.5f)));
  add_object(scene, PlaneShape{{0, 0, 1}, -5}, add_material(scene, glowing({1, 1, 1})));
  const double r = 0.04;
  const double through = (1 - r) * (1 - r) / (1 - r * r);
  // Rays of the last millesimal are cut off.
  EXPECT_NEAR(value(run(scene).picture, "R", 0, 0), through, 1e-3);
  scene.background = {1, 1, 1};
  EXPECT_NEAR(value(run(scene).picture, "R", 0, 0), 1, 1e-3);
}

TEST(Transparency, RefractionBendsBySnell) {
  // From above, at 45 degrees, into a pool one unit deep: the point seen on its ground shifts as Snell's law
  // says.
  Scene scene = bare_scene(1);
  scene.camera.from = {-3, 3, 0}, scene.camera.at = {0, 0, 0};
  scene.lights = {};
  const std::uint32_t water = add_material(scene, glass(1.33f));
  add_object(scene, PlaneShape{{0, 1, 0}, 0}, water);
  const double sine = std::sqrt(0.5) / 1.33, shift = sine / std::sqrt(1 - sine * sine);
  const auto ground_at = [&](double x) {
    Scene s = scene;
    add_object(s, DiskShape{{x, -1, 0}, {0, 1, 0}, 0.01}, add_material(s, glowing({1, 1, 1})));
    return value(run(s).picture, "R", 0, 0);
  };
  EXPECT_GT(ground_at(shift), 0.9f);
  EXPECT_EQ(ground_at(shift + 0.03), 0);
  EXPECT_EQ(ground_at(1), 0);
}

TEST(Transparency, BeyondTheCriticalAngleAllIsReflected) {
  // From inside the glass below z = 0 towards its surface at 45 degrees (critical angle 41.8): what is seen
  // lies inside.
  Scene scene = bare_scene(1);
  scene.camera.from = {-1, 0, -1}, scene.camera.at = {0, 0, 0};
  add_object(scene, PlaneShape{{0, 0, 1}, 0}, add_material(scene, glass(1.5f)));
  add_object(scene, SphereShape{{5, 0, -5}, 1}, add_material(scene, glowing({1, 0, 0})));
  add_object(scene, PlaneShape{{0, 0, 1}, 3}, add_material(scene, glowing({0, 1, 0})));
  const RenderResult r = run(scene);
  EXPECT_NEAR(length(color(r.picture, 0, 0) - Color{1, 0, 0}), 0, 1e-6f);
  EXPECT_EQ(r.report.refracted_rays, 0u);
}

TEST(Transparency, ShadowsTakeTheColourOfTheGlass) {
  Scene scene = bare_scene(15);
  scene.camera.from = {0, 5, 0}, scene.camera.up = {0, 0, -1};
  add_object(scene, PlaneShape{}, add_material(scene, diffuse({1, 1, 1})));
  Material m = glass(1.5f);
  m.color = {1, 0.5f, 0};
  m.transparency = 0.5f;
  const std::uint32_t tinted = add_material(scene, m);
  add_object(scene, BoxShape{{1, 1, -1}, {2, 2, 1}}, tinted);
  for (const Light& light :
       {Light(PointLight{{3, 3, 0}, {1, 1, 1}, false}), Light(DirectionalLight{{-1, -1, 0}, {1, 1, 1}})}) {
    scene.lights = {light};
    const Color c = color(run(scene).picture, 7, 7);
    // Both faces are met at 45 degrees, where Fresnel's equations take 5.02 % of the light. What they reflect
    // to each other is halved each time.
    const float lost = 0.050239f, passed = (1 - lost) * (1 - lost) / (1 - 0.25f * lost * lost);
    EXPECT_NEAR(length(c - Color{0.25f, 0.0625f, 0} * (passed * std::sqrt(0.5f))), 0, 1e-5f);
  }
  // An opaque thing behind the glass blocks the light; one behind the point light does not.
  add_object(scene, SphereShape{{2.5, 2.5, 0}, 0.2}, 0);
  EXPECT_EQ(color(run(scene).picture, 7, 7), (Color{0, 0, 0}));
  scene.objects.pop_back();
  add_object(scene, SphereShape{{4, 4, 0}, 0.2}, 0);
  scene.lights = {PointLight{{3, 3, 0}, {1, 1, 1}, false}};
  EXPECT_GT(color(run(scene).picture, 7, 7).x, 0.1f);
}

}  // namespace
}  // namespace oktett::transparency_test
