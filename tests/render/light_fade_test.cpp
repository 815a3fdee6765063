// Light that fades, spots that are tight, and lights without shadows or highlights.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/light/emitter.h"
#include "tests/render/test_scenes.h"

namespace oktett::light_fade_test {
namespace {

using namespace test;

/// A plane z = 0 under a light at height 5, by the textbook: `left` gives the part of the light that is left
/// at a distance and a cosine to -z.
template <class Left>
void expect_on_plane(const Light& light, const Left& left) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path}) {
    Scene scene = bare_scene(24);
    scene.integrator.kind = kind;
    scene.camera.projection = Projection::orthographic, scene.camera.height = 20;
    scene.camera.from = {0, 0, 50}, scene.camera.at = {0, 0, 0};
    add_object(scene, PlaneShape{{0, 0, 1}, 0}, add_material(scene, diffuse({1, 1, 1})));
    scene.lights = {light};
    const Picture p = run(scene).picture;
    for (std::uint32_t y = 0; y < p.height; y += 3)
      for (std::uint32_t x = 0; x < p.width; x += 3) {
        const Vec3d at(position(p, x, y));
        const double distance = length(Vec3d{0, 0, 5} - at), cosine = 5 / distance;
        EXPECT_NEAR(color(p, x, y).x, 0.5 * cosine * left(distance, cosine), 2e-5) << x << ',' << y;
      }
  }
}

TEST(LightFade, PointsFadeWithTheDistance) {
  for (const double distance : {2.0, 5.0, 9.0})
    for (const double power : {1.0, 2.0, 3.5}) {
      PointLight light{{0, 0, 5}, {0.5f, 0.5f, 0.5f}};
      light.fade = {distance, power};
      expect_on_plane(light, [&](double r, double) { return 2 / (1 + std::pow(r / distance, power)); });
    }
}

TEST(LightFade, SpotsAreTight) {
  for (const double tightness : {0.5, 1.0, 10.0}) {
    SpotLight light{{0, 0, 5}, {0, 0, -1}, {0.5f, 0.5f, 0.5f}, 60, 70};
    light.falloff = false, light.tightness = tightness;
    light.fade = {6, 2};
    const double inner = std::cos(60 * kDegree), outer = std::cos(70 * kDegree);
    expect_on_plane(light, [&](double r, double cosine) {
      const double t = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
      return 2 / (1 + r * r / 36) * std::pow(cosine, tightness) * t * t * (3 - 2 * t);
    });
  }
}

// Brightness of points of a plane under a spot at height 5, as POV-Ray 3.7.0.10 shows it.
TEST(LightFade, SpotsAreThoseOfPovRay) {
  const auto shown = [](double inner, double outer, double tightness, double x) {
    const SpotEmitter spot{.position = {0, 0, 5},
                           .axis = {0, 0, -1},
                           .intensity = {1, 1, 1},
                           .cos_inner = static_cast<float>(std::cos(inner * kDegree)),
                           .cos_outer = static_cast<float>(std::cos(outer * kDegree)),
                           .falloff = false,
                           .tightness = tightness};
    LightPoint point;
    point.position = {static_cast<float>(x), 0, 0};
    const auto s = sample_emitter(spot, point, {});
    return s ? s->radiance.x * s->direction.z : 0;
  };
  EXPECT_NEAR(shown(20, 40, 0, 2), 0.9174, 1e-3);
  EXPECT_NEAR(shown(20, 40, 0, 3), 0.4630, 1e-3);
  EXPECT_NEAR(shown(20, 40, 10, 1), 0.8060, 1e-3);
  EXPECT_NEAR(shown(20, 40, 10, 2), 0.4368, 1e-3);
  EXPECT_NEAR(shown(60, 70, 3, 5), 0.2500, 1e-3);
  EXPECT_NEAR(shown(60, 70, 3, 10), 0.0296, 1e-3);
}

/// Brightness of points x of a plane z = 0 under a light from above.
std::vector<float> on_line(const Light& light, bool roof, const std::vector<double>& places) {
  std::vector<float> shown;
  for (const double x : places) {
    Scene scene = bare_scene(1);
    scene.camera.projection = Projection::orthographic, scene.camera.height = 1e-3;
    scene.camera.from = {x, 0, 3}, scene.camera.at = {x, 0, 0};
    add_object(scene, PlaneShape{{0, 0, 1}, 0}, add_material(scene, diffuse({1, 1, 1})));
    if (roof) add_object(scene, PlaneShape{{0, 0, 1}, 8}, add_material(scene, diffuse({1, 1, 1})));
    scene.lights = {light};
    shown.push_back(color(run(scene).picture, 0, 0).x);
  }
  return shown;
}

// As POV-Ray 3.7.0.10 shows light that is a cylinder.
TEST(LightFade, BeamsAreThoseOfPovRay) {
  const auto expect = [](const LightBeam& beam, const std::vector<double>& places,
                         const std::vector<double>& want) {
    DirectionalLight light{{0, 0, -1}, {1, 1, 1}};
    light.from = Vec3d{0, 0, 5}, light.beam = beam;
    for (const bool roof : {false, true}) {
      const std::vector<float> found = on_line(light, roof, places);
      for (std::size_t i = 0; i < want.size(); ++i) EXPECT_NEAR(found[i], want[i], 2e-4) << places[i];
    }
  };
  expect({4, 1, 5}, {0, 0.5, 1, 1.5, 2, 2.5, 3, 4}, {1, 0.5129, 0.2373, 0.0883, 0.0231, 0.0037, 0.0003, 0});
  expect({4, 3, 2}, {0, 1, 2, 3, 3.5, 4, 5}, {1, 0.5625, 0.25, 0.0625, 0.0078, 0, 0});
  expect({3, 0.75, 0}, {0.5, 1, 1.5, 2, 2.5, 3}, {1, 0.9657, 0.7407, 0.4170, 0.1262, 0});
  expect({2, 2, 0}, {1, 1.99, 2.01}, {1, 1, 0});
}

TEST(LightFade, ParallelLightMayBeginSomewhere) {
  DirectionalLight light{{0, 0, -1}, {0.5f, 0.5f, 0.5f}};
  EXPECT_EQ(on_line(light, true, {0})[0], 0);
  light.from = Vec3d{7, 7, 5};
  EXPECT_NEAR(on_line(light, true, {0})[0], 0.5, 1e-5);
  light.fade = {2, 1};
  EXPECT_NEAR(on_line(light, true, {0})[0], 0.2857, 1e-4);
  // Above the roof it shadows.
  light.from = Vec3d{0, 0, 9};
  EXPECT_EQ(on_line(light, true, {0})[0], 0);
  // Surfaces behind its place have its light, but not that of a beam.
  light.from = Vec3d{0, 0, -1}, light.fade = {};
  EXPECT_NEAR(on_line(light, false, {0})[0], 0.5, 1e-5);
  light.beam = {2, 2, 0};
  EXPECT_EQ(on_line(light, false, {0})[0], 0);
}

// A sheet between light and ball takes the light, but not that of a light without shadows.
TEST(LightFade, LightsWithoutShadowsPassAllThings) {
  for (const bool directional : {false, true}) {
    const auto brightness = [&](bool shadows, bool blocked) {
      Scene scene = bare_scene(9);
      scene.camera.from = {0, 0, 4}, scene.camera.at = {0, 0, 0};
      add_object(scene, SphereShape{{0, 0, 0}, 1}, add_material(scene, diffuse({1, 1, 1})));
      if (blocked) add_object(scene, PlaneShape{{0, 0, 1}, 6}, add_material(scene, diffuse({1, 1, 1})));
      if (directional)
        scene.lights = {DirectionalLight{{0, 0, -1}, {1, 1, 1}}};
      else
        scene.lights = {PointLight{{0, 0, 9}, {1, 1, 1}}};
      scene.light_traits.resize(1);
      scene.light_traits[0].shadows = shadows;
      return color(run(scene).picture, 4, 4).x;
    };
    EXPECT_NEAR(brightness(true, false), 1, 1e-3);
    EXPECT_EQ(brightness(true, true), 0);
    EXPECT_NEAR(brightness(false, true), 1, 1e-3);
  }
}

TEST(LightFade, LightsWithoutHighlightsAreDiffuse) {
  const auto brightness = [&](bool highlights, bool textured) {
    Scene scene = bare_scene(9);
    scene.camera.from = {0, 0, 4}, scene.camera.at = {0, 0, 0};
    Material m = diffuse({0.25f, 0.25f, 0.25f});
    m.specular = 0.5f, m.phong = 10;
    // Whose hits are shaded one by one.
    if (textured) m.filter = Color{1, 1, 1};
    add_object(scene, SphereShape{{0, 0, 0}, 1}, add_material(scene, m));
    scene.lights = {PointLight{{0, 0, 9}, {1, 1, 1}}};
    scene.light_traits.resize(1);
    scene.light_traits[0].highlights = highlights;
    return color(run(scene).picture, 4, 4).x;
  };
  for (const bool textured : {false, true}) {
    EXPECT_NEAR(brightness(true, textured), 0.75, 1e-3);
    EXPECT_NEAR(brightness(false, textured), 0.25, 1e-3);
  }
}

}  // namespace
}  // namespace oktett::light_fade_test
