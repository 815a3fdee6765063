// Highlights by Blinn, brilliance and grain in Whitted's model, against what POV-Ray 3.7.0.10 shows.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/render/test_scenes.h"

namespace oktett::highlight_test {
namespace {

using namespace test;

/// A plane z = 0 that is turned by an angle about the x axis, seen from where its light comes from.
Scene turned_plane(const Material& m, double degrees) {
  Scene scene = bare_scene(1);
  scene.integrator.kind = IntegratorKind::whitted;
  scene.ambient_light = {0, 0, 0};
  scene.camera.projection = Projection::orthographic, scene.camera.height = 1e-2;
  scene.camera.from = {0, 0, 10}, scene.camera.at = {0, 0, 0};
  const double angle = degrees * (std::numbers::pi / 180);
  add_object(scene, PlaneShape{{0, std::sin(angle), std::cos(angle)}, 0}, add_material(scene, m));
  scene.lights = {DirectionalLight{{0, 0, -1}, {1, 1, 1}}};
  return scene;
}

double seen(const Material& m, double degrees) {
  return double{color(run(turned_plane(m, degrees)).picture, 0, 0).x};
}

Material white(float diffuse) {
  Material m;
  m.color = {1, 1, 1}, m.diffuse = diffuse, m.ambient = 0;
  return m;
}

TEST(Highlight, BrillianceIsAPowerOfTheCosine) {
  Material m = white(1);
  m.brilliance = 3;
  EXPECT_NEAR(seen(m, 60), 0.125, 1e-5);
  m.brilliance = 0.5f;
  EXPECT_NEAR(seen(m, 60), 0.70703, 2e-4);
  m.brilliance = 0;
  EXPECT_NEAR(seen(m, 80), 1, 1e-5);
}

TEST(Highlight, BlinnsIsAboutTheHalfwayDirection) {
  Material m = white(0);
  m.specular_blinn = 0.5f, m.blinn = 10;
  // Seen from the light, the halfway direction is the way to it.
  EXPECT_NEAR(seen(m, 15), 0.353516, 1e-4);
  for (const double degrees : {0.0, 30.0, 60.0})
    EXPECT_NEAR(seen(m, degrees), 0.5 * std::pow(std::cos(degrees * (std::numbers::pi / 180)), 10), 1e-5);
  // Beside Phong's, and off the axis.
  m.specular = 0.25f, m.phong = 4;
  Scene scene = turned_plane(m, 20);
  scene.lights = {DirectionalLight{{0, -1, -1}, {1, 1, 1}}};
  const Vec3d n{0, std::sin(20 * (std::numbers::pi / 180)), std::cos(20 * (std::numbers::pi / 180))};
  const Vec3d l = normalize(Vec3d{0, 1, 1}), v{0, 0, 1}, h = normalize(l + v);
  const Vec3d mirrored = n * (2 * dot(n, l)) - l;
  EXPECT_NEAR(color(run(scene).picture, 0, 0).x,
              0.5 * std::pow(dot(n, h), 10) + 0.25 * std::pow(dot(mirrored, v), 4), 1e-5);
  // Not where the light is behind the surface.
  scene.lights = {DirectionalLight{{0, 1, 1}, {1, 1, 1}}};
  EXPECT_EQ(color(run(scene).picture, 0, 0).x, 0);
}

TEST(Highlight, LightsWithoutHighlightsShowNoneOfBlinn) {
  Material m = white(0);
  m.specular_blinn = 0.5f;
  Scene scene = turned_plane(m, 0);
  scene.light_traits.resize(1);
  scene.light_traits[0].highlights = false;
  EXPECT_EQ(color(run(scene).picture, 0, 0).x, 0);
}

// POV-Ray shows 0.5 to 0.8, of the mean 0.635 in 100 pixels.
TEST(Highlight, GrainTakesARandomPartOfDiffuseLight) {
  Material m = white(0.8f);
  m.grain = 0.3f;
  Scene scene = turned_plane(m, 0);
  scene.film.width = scene.film.height = 64;
  const RenderResult result = run(scene);
  double least = 1, most = 0, sum = 0;
  for (std::uint32_t y = 0; y < 64; ++y)
    for (std::uint32_t x = 0; x < 64; ++x) {
      const double v = double{color(result.picture, x, y).x};
      least = std::min(least, v), most = std::max(most, v), sum += v;
    }
  EXPECT_GE(least, 0.5 - 1e-6);
  EXPECT_LE(most, 0.8 + 1e-6);
  EXPECT_LT(least, 0.51);
  EXPECT_GT(most, 0.79);
  EXPECT_NEAR(sum / (64 * 64), 0.65, 0.01);
  // Less light than it may take is none.
  m.grain = 1000;
  EXPECT_LT(seen(m, 0), 1e-2);
}

}  // namespace
}  // namespace oktett::highlight_test
