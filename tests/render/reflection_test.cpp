// Mirrors that depend on the angle, and glass whose light is not split, against Fresnel's equations and what
// POV-Ray 3.7.0.10 shows.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/render/test_scenes.h"

namespace oktett::reflection_test {
namespace {

using namespace test;

/// What a plane y = 0 shows that is seen at an angle to its normal: below it all is blue, above it red.
Color seen(const Material& m, double degrees, IntegratorKind kind = IntegratorKind::whitted) {
  Scene scene = bare_scene(1);
  scene.integrator.kind = kind;
  scene.camera.projection = Projection::orthographic, scene.camera.height = 1e-4;
  const double angle = degrees * (std::numbers::pi / 180);
  scene.camera.from = Vec3d{-std::sin(angle), std::cos(angle), 0} * 3, scene.camera.at = {0, 0, 0};
  scene.camera.up = {0, 0, 1};
  add_object(scene, PlaneShape{{0, 1, 0}, 0}, add_material(scene, m));
  Texture sky;
  sky.pattern.emplace();
  sky.pattern->pattern = GradientPattern{{0, -1e-6, 0}, {0, 1e-6, 0}};
  sky.pattern->colors = {{0, 0, 1}, {1, 0, 0}};
  scene.textures = {sky};
  scene.background = {1, 1, 1}, scene.background_texture = 0;
  return color(run(scene).picture, 0, 0);
}

/// Unpolarized, of light that arrives outside of something of that index.
double reflectance(double cosine, double ior) {
  const double inside = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
  const double s = (cosine - ior * inside) / (cosine + ior * inside);
  const double p = (inside - ior * cosine) / (inside + ior * cosine);
  return (s * s + p * p) / 2;
}

Material varying(float head_on, float grazing, float falloff, float ior = 1.5f) {
  Material m = diffuse({0, 0, 0});
  m.diffuse = 0, m.ior = ior;
  m.reflection = head_on, m.reflection_grazing = grazing, m.reflection_falloff = falloff;
  m.reflection_varies = true;
  return m;
}

TEST(Reflection, GrowsWithTheAngle) {
  for (const double degrees : {0.0, 30.0, 60.0, 80.0}) {
    const double c = std::cos(degrees * (std::numbers::pi / 180));
    for (const double falloff : {0.5, 1.0, 3.0})
      EXPECT_NEAR(seen(varying(0.1f, 0.9f, static_cast<float>(falloff)), degrees).x,
                  0.1 + 0.8 * std::pow(1 - c, falloff), 2e-6);
    for (const double ior : {1.2, 1.5, 3.0})
      EXPECT_NEAR(seen(varying(0.1f, 0.9f, 0, static_cast<float>(ior)), degrees).x,
                  0.1 + 0.8 * reflectance(c, ior), 2e-6);
  }
}

TEST(Reflection, MayHaveAnotherColourThanHighlights) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path}) {
    Material m = diffuse({0, 0, 0});
    m.diffuse = 0, m.reflection = 0.5f;
    m.specular_color = {0, 1, 0}, m.reflection_color = Color{0.5f, 1, 1};
    EXPECT_NEAR(seen(m, 30, kind).x, 0.25, 1e-5);
    m.reflection_color.reset();
    EXPECT_EQ(seen(m, 30, kind).x, 0);
  }
}

// Below the horizon all is blue: what is seen of the plane from below is its back.
TEST(Reflection, BacksMayHaveAnotherMaterial) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path, IntegratorKind::albedo})
    for (const bool above : {true, false}) {
      Scene scene = bare_scene(1);
      scene.integrator.kind = kind, scene.integrator.depth = 1;
      scene.camera.projection = Projection::orthographic, scene.camera.height = 1e-4;
      scene.camera.from = {0, above ? 3.0 : -3.0, 0}, scene.camera.at = {0, 0, 0},
      scene.camera.up = {0, 0, 1};
      scene.background = {1, 1, 1};
      Material front = mirror(), back = mirror();
      front.color = {1, 0, 0}, back.color = {0, 1, 0};
      front.specular_color = {1, 0, 0}, back.specular_color = {0, 1, 0};
      front.back = add_material(scene, back);
      add_object(scene, PlaneShape{{0, 1, 0}, 0}, add_material(scene, front));
      const Color shown = color(run(scene).picture, 0, 0);
      EXPECT_NEAR(shown.x, above ? 1 : 0, 1e-5) << static_cast<int>(kind);
      EXPECT_NEAR(shown.y, above ? 0 : 1, 1e-5) << static_cast<int>(kind);
    }
}

TEST(Reflection, IsThatOfPovRay) {
  constexpr double kNear = 2e-5;
  EXPECT_NEAR(seen(varying(0.1f, 0.9f, 1), 30).x, 0.20719, kNear);
  EXPECT_NEAR(seen(varying(0.1f, 0.9f, 3), 80).x, 0.55143, kNear);
  EXPECT_NEAR(seen(varying(0, 1, 0), 80).x, 0.38770, kNear);
  EXPECT_NEAR(seen(varying(0.1f, 0.9f, 0), 60).x, 0.17134, kNear);
  EXPECT_NEAR(seen(varying(0.9f, 0.1f, 1), 60).x, 0.5, kNear);
}

TEST(Reflection, GrowsInPathsToo) {
  // The weight is exact, as mirror rays have the weight that they are chosen with.
  const Color mean = seen(varying(0.25f, 0.25f, 1), 60, IntegratorKind::path);
  EXPECT_NEAR(mean.x, 0.25, 1e-6);
  EXPECT_NEAR(seen(varying(0.1f, 0.9f, 1), 60, IntegratorKind::path).x, 0.5, 1e-6);
}

TEST(Reflection, OfGlassNeedNotBeSplit) {
  Material m = glass(1.5f);
  m.filter = Color{0.8f, 0.8f, 0.8f}, m.fresnel = false;
  for (const double degrees : {0.0, 60.0, 80.0}) {
    EXPECT_NEAR(seen(m, degrees).z, 0.8, 1e-6);
    EXPECT_EQ(seen(m, degrees).x, 0);
  }
  m.ior = 0.5f, m.transparency = 0.5f, m.reflection = 0.3f;
  EXPECT_NEAR(seen(m, 0).x, 0.3, 1e-6);
  EXPECT_NEAR(seen(m, 0).z, 0.4, 1e-6);
  // Nothing can be refracted: all is mirrored, as in POV-Ray.
  EXPECT_NEAR(seen(m, 60).x, 1, 1e-6);
  EXPECT_EQ(seen(m, 60).z, 0);
}

TEST(Reflection, IsTakenFromWhatPasses) {
  Material m = glass(1);
  m.filter = Color{0.8f, 0.8f, 0.8f}, m.fresnel = false, m.conserve_energy = true;
  m.reflection = 0.6f, m.specular_color = {0.5f, 1, 1};
  EXPECT_NEAR(seen(m, 30).x, 0.3, 1e-6);
  EXPECT_NEAR(seen(m, 30).z, 0.32, 1e-6);  // 0.8 (1 - 0.6), as in POV-Ray
  Material varied = varying(0, 1, 0);
  varied.transparency = 1, varied.filter = Color{1, 1, 1}, varied.fresnel = false,
  varied.conserve_energy = true;
  EXPECT_NEAR(seen(varied, 80).z, 0.6123, 2e-5);
}

/// As light that is taken straight.
TEST(Reflection, DoesNotDimShadowsOfGlassThatDoesNotSplitLight) {
  Scene scene = bare_scene(1);
  scene.camera.projection = Projection::orthographic, scene.camera.height = 1e-3;
  scene.camera.from = {0, 0.5, 0}, scene.camera.at = {0, 0, 0}, scene.camera.up = {0, 0, 1};
  add_object(scene, PlaneShape{{0, 1, 0}, 0}, add_material(scene, diffuse({1, 1, 1})));
  Material pane = glass(1.5f);
  pane.filter = Color{0.8f, 0.8f, 0.8f}, pane.fresnel = false;
  add_object(scene, BoxShape{{-1, 1, -1}, {1, 2, 1}}, add_material(scene, pane));
  scene.lights = {DirectionalLight{}};
  EXPECT_NEAR(color(run(scene).picture, 0, 0).x, 0.64, 1e-5);
}

}  // namespace
}  // namespace oktett::reflection_test
