// Media in Whitted's model against integrals in double and what POV-Ray 3.7.0.10 shows.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/render/test_scenes.h"

namespace oktett::whitted_media_test {
namespace {

using namespace test;

/// A ball of radius 1 around the origin, full of the medium, seen from z = 5 along -z through its middle.
Scene ball_scene(const Medium& medium, const Color& background = {0, 0, 0}) {
  Scene scene = bare_scene(1);
  scene.camera.projection = Projection::orthographic, scene.camera.height = 1e-4;
  scene.camera.from = {0, 0, 5}, scene.camera.at = {0, 0, 0};
  scene.background = background;
  scene.media = {medium};
  Material clear = glass(1);
  clear.interior = 0;
  add_object(scene, SphereShape{{0, 0, 0}, 1}, add_material(scene, clear));
  return scene;
}

Color shown(const Scene& scene) { return color(run(scene).picture, 0, 0); }

void expect_color(const Color& found, const Vec3d& want, double tolerance = 2e-6) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], want[k], tolerance) << k;
}

double integral(const std::function<double(double)>& f, double from, double to) {
  constexpr int kSteps = 20000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) sum += f(from + (to - from) * (i + 0.5) / kSteps);
  return sum * (to - from) / kSteps;
}

TEST(WhittedMedia, GlowAndAbsorb) {
  Medium medium;
  medium.emission = {0.1f, 0.2f, 0.3f};
  expect_color(shown(ball_scene(medium)), {0.2, 0.4, 0.6});
  medium.absorption = {0.5f, 1, 2};
  expect_color(shown(ball_scene(medium, {1, 1, 1})),
               {std::exp(-1) + 0.2 * (1 - std::exp(-1)), std::exp(-2) + 0.2 * (1 - std::exp(-2)),
                std::exp(-4) + 0.15 * (1 - std::exp(-4))});
}

/// A density of 1 - r within the ball.
Scene spherical_scene(const Medium& medium, const Color& background) {
  Scene scene = ball_scene(medium, background);
  Texture density;
  density.pattern.emplace();
  density.pattern->pattern = SphericalPattern{};
  density.pattern->colors = {{0, 0, 0}, {1, 2, 4}};
  scene.textures = {density};
  scene.media[0].density_texture = 0, scene.media[0].steps = 400;
  return scene;
}

TEST(WhittedMedia, HaveThePatternOfTheirDensity) {
  Medium medium;
  medium.emission = {0.2f, 0.2f, 0.2f};
  expect_color(shown(spherical_scene(medium, {0, 0, 0})), {0.2, 0.4, 0.8}, 1e-5);
  medium.absorption = {1, 0.5f, 0.25f};  // times the density all are alike
  const double left = std::exp(-1);
  expect_color(shown(spherical_scene(medium, {1, 1, 1})),
               {left + 0.2 * (1 - left), left + 0.4 * (1 - left), left + 0.8 * (1 - left)}, 1e-5);
  // The place of the density is its own.
  Scene moved = spherical_scene(medium, {1, 1, 1});
  moved.media[0].grid_place = Affine::translation({0, 0.5, 0}) * Affine::scaling(Vec3d{1, 1, 1} * 0.5);
  expect_color(shown(moved), {1, 1, 1}, 1e-5);
}

TEST(WhittedMedia, ScatterLightOnce) {
  for (const double g : {0.0, 0.5, -0.3})
    for (const double extinction : {1.0, 0.0, 0.25}) {
      Medium medium;
      medium.scattering = {0.5f, 0.5f, 0.5f}, medium.anisotropy = static_cast<float>(g);
      medium.extinction = extinction, medium.steps = 200;
      Scene scene = ball_scene(medium);
      scene.lights = {DirectionalLight{{0, -1, 0}, {0.7f, 0.7f, 0.7f}}};
      // Light comes at a right angle, through the ball from its upper side.
      const double square = 1 + g * g,
                   phase = (1 - g * g) / (square * std::sqrt(square)) / (4 * std::numbers::pi);
      const double sigma = 0.5 * extinction;
      const double want = integral(
          [&](double z) {
            const double above = std::sqrt(1 - z * z);
            return 0.5 * phase * 0.7 * std::numbers::pi * std::exp(-sigma * (1 - z)) *
                   std::exp(-sigma * above);
          },
          -1, 1);
      expect_color(shown(scene), Vec3d{1, 1, 1} * want, 2e-5);
    }
}

// At 90, 180 and 0 degrees to a lamp, with scattering of 0.05 without extinction. There it is as strong as
// light on a surface, times the strength of the kind.
TEST(WhittedMedia, ScatterAsPovRayDoes) {
  const auto seen = [](PhaseKind phase, double strength, float g, const Vec3d& travels) {
    Medium medium;
    const auto s = static_cast<float>(0.05 * 4 * strength);
    medium.scattering = {s, s, s}, medium.extinction = 0, medium.phase = phase, medium.anisotropy = g;
    Scene scene = ball_scene(medium);
    scene.lights = {DirectionalLight{travels, {1, 1, 1}}};
    return shown(scene).x;
  };
  const Vec3d across{0, -1, 0}, along{0, 0, -1}, against{0, 0, 1};
  using enum PhaseKind;
  EXPECT_NEAR(seen(henyey_greenstein, 1, 0, across), 0.1, 2e-5);
  EXPECT_NEAR(seen(haze, 2 * 0.576655, 0, across), 0.05969, 2e-5);
  EXPECT_NEAR(seen(haze, 2 * 0.576655, 0, along), 0.05766, 2e-5);
  EXPECT_NEAR(seen(haze, 2 * 0.576655, 0, against), 0.57665, 2e-5);
  EXPECT_NEAR(seen(murk, (1 + 50.0 / 33) * 0.495715, 0, along), 0.04958, 2e-5);
  EXPECT_NEAR(seen(rayleigh, 4.0 / 3 * 0.799372, 0, across), 0.07994, 2e-5);
  EXPECT_NEAR(seen(rayleigh, 4.0 / 3 * 0.799372, 0, against), 0.15987, 2e-5);
  EXPECT_NEAR(seen(henyey_greenstein, 1, 0.5f, against), 0.6, 2e-5);
  EXPECT_NEAR(seen(henyey_greenstein, 1, 0.5f, along), 0.02222, 2e-5);
}

TEST(WhittedMedia, LieInTheShadowOfThings) {
  Medium medium;
  medium.scattering = {0.5f, 0.5f, 0.5f}, medium.extinction = 0, medium.steps = 100;
  Scene scene = ball_scene(medium);
  scene.lights = {DirectionalLight{{0, -1, 0}, {1, 1, 1}}};
  const float whole = shown(scene).x;
  add_object(scene, BoxShape{{-1, 2, 0}, {1, 3, 5}}, add_material(scene, diffuse({1, 1, 1})));
  EXPECT_NEAR(shown(scene).x, whole / 2, 1e-5);
  // What stands in the medium hides what is behind it, and the way ends there.
  scene.objects.pop_back();
  scene.lights.clear(), scene.media[0].emission = {1, 1, 1};
  add_object(scene, SphereShape{{0, 0, 0}, 0.25}, add_material(scene, diffuse({0, 0, 0})));
  EXPECT_NEAR(shown(scene).x, 0.75, 1e-5);
  // A pane in it, and behind that the rest.
  scene.objects.pop_back();
  Material pane = glass(1);
  pane.filter = Color{0.5f, 0.5f, 0.5f};
  add_object(scene, DiskShape{{0, 0, 0.5}, {0, 0, 1}, 0.2}, add_material(scene, pane));
  EXPECT_NEAR(shown(scene).x, 0.5 + 0.5 * 1.5, 1e-5);
}

TEST(WhittedMedia, FadeByAPowerOfTheWay) {
  const auto seen = [](double distance, double power, float color) {
    Medium medium;
    medium.fade = {distance, power, {color, color, color}};
    return shown(ball_scene(medium, {1, 1, 1})).x;
  };
  // POV-Ray's fade_distance, fade_power and fade_color.
  EXPECT_NEAR(seen(1, 1, 0.2f), 0.46667, 2e-5);
  EXPECT_NEAR(seen(1, 2, 0.5f), 0.6, 2e-5);
  EXPECT_NEAR(seen(3, 1, 0), 0.6, 2e-5);
  EXPECT_NEAR(seen(3, 2, 0.2f), 0.75384, 2e-5);
}

TEST(WhittedMedia, FillTheSpaceOutsideOfSolids) {
  for (const bool hollow : {false, true}) {
    Medium medium;
    medium.absorption = {0.1f, 0.1f, 0.1f};
    Scene scene = ball_scene(medium);
    scene.materials[0].interior = kNoId;
    scene.objects[0].hollow = hollow, scene.medium = 0;
    add_object(scene, PlaneShape{{0, 0, 1}, -5}, add_material(scene, glowing({1, 1, 1})));
    expect_color(shown(scene), Vec3d{1, 1, 1} * std::exp(hollow ? -1 : -0.8), 1e-5);
  }
}

TEST(WhittedMedia, AreAroundTheCameraToo) {
  Medium medium;
  medium.emission = {0.1f, 0.1f, 0.1f};
  Scene scene = ball_scene(medium);
  scene.camera.from = {0, 0, 0.5};
  expect_color(shown(scene), Vec3d{1, 1, 1} * 0.15, 1e-5);
}

}  // namespace
}  // namespace oktett::whitted_media_test
