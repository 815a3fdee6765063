/// \file The solids around a path: stacks of them, cameras inside, light in their interiors.

#include "render/dielectric_stack.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/bsdf/optics.h"
#include "tests/render/medium_support.h"

namespace oktett::dielectrics_test {
namespace {

using namespace test;

TEST(DielectricStack, RemovesWhatWasEntered) {
  DielectricStack stack;
  stack.leave({1, 1});
  EXPECT_EQ(stack.size(), 0u);
  stack.enter({1, 10}), stack.enter({2, 20}), stack.enter({1, 11});
  stack.leave({1, 10});
  ASSERT_EQ(stack.size(), 2u);
  EXPECT_EQ(stack[0], (StackedDielectric{2, 20}));
  EXPECT_EQ(stack[1], (StackedDielectric{1, 11}));
  // By another material of the same solid.
  stack.leave({2, 99});
  ASSERT_EQ(stack.size(), 1u);
  EXPECT_EQ(stack[0].solid, 1u);
  stack.leave({3, 11});
  EXPECT_EQ(stack.size(), 1u);
}

TEST(DielectricStack, ForgetsTheFirstOfTooMany) {
  DielectricStack stack;
  for (std::uint32_t i = 0; i < DielectricStack::kMost + 3; ++i) stack.enter({i, i});
  ASSERT_EQ(stack.size(), DielectricStack::kMost);
  EXPECT_EQ(stack[0].solid, 3u);
  EXPECT_EQ(stack[DielectricStack::kMost - 1].solid, DielectricStack::kMost + 2);
}

/// Balls around the origin and a half-space below y = 2, all of glass with a priority.
World nested_world(Scene& scene) {
  scene.integrator.kind = IntegratorKind::path;
  for (const double radius : {3.0, 1.0, 2.0}) {
    Material m = glass(1.5f);
    m.priority = 1;
    add_object(scene, SphereShape{{0, 0, 0}, radius}, add_material(scene, m));
  }
  Material water = glass(1.33f);
  water.priority = 0;
  add_object(scene, PlaneShape{{0, 1, 0}, 2}, add_material(scene, water));
  return build_world(scene);
}

TEST(Dielectrics, AreFoundAtAnyPoint) {
  Scene scene;
  const World world = nested_world(scene);
  RenderContext context;
  context.world = &world;
  const auto solids_at = [&](const Vec3f& point) {
    const DielectricStack stack = dielectrics_at(context, point);
    std::vector<std::uint32_t> solids;
    for (std::uint32_t i = 0; i < stack.size(); ++i) solids.push_back(stack[i].solid);
    return solids;
  };
  using Solids = std::vector<std::uint32_t>;
  EXPECT_EQ(solids_at({9, 9, 9}), Solids{});
  EXPECT_EQ(solids_at({9, -9, 9}), (Solids{3}));
  EXPECT_EQ(solids_at({0, 2.5f, 0}), (Solids{0}));
  EXPECT_EQ(solids_at({0, 0.1f, 0}).size(), 4u);
  EXPECT_EQ(solids_at({0, 0.1f, 0}).back(), 1u) << "the innermost ball comes last";
  EXPECT_EQ(solids_at({0, -1.5f, 0}).size(), 3u);
}

TEST(Dielectrics, OpenSurfacesAndOpaqueMaterialsHaveNoInside) {
  Scene scene;
  scene.integrator.kind = IntegratorKind::path;
  const std::uint32_t clear = add_material(scene, filled(scene, 1.5f, {1, 1, 1}));
  const std::uint32_t opaque = add_material(scene, diffuse({1, 1, 1}));
  add_object(scene, DiskShape{{0, 0, 0}, {0, 0, 1}, 1}, clear);
  CylinderShape tube;
  tube.open = true;
  add_object(scene, ExactShape{tube}, clear);
  add_object(scene, SphereShape{{0, 0, 0}, 4}, opaque);
  const World world = build_world(scene);
  EXPECT_FALSE(world.has_enclosing_solids);
  RenderContext context;
  context.world = &world;
  EXPECT_EQ(dielectrics_at(context, {0, 0, 0}).size(), 0u);
}

// The camera in a ball of glass, in smoke in glass, and below a water level that no upward ray leaves twice.
TEST(Dielectrics, TheCameraMayBeginInside) {
  Scene scene = medium_scene(1, 4);
  scene.camera.from = {0, 0, 0}, scene.camera.at = {0, 0, -1};
  add_object(scene, PlaneShape{{0, 0, 1}, -10}, add_material(scene, glowing({1, 1, 1})));
  add_object(scene, SphereShape{{0, 0, 0}, 2}, add_material(scene, filled(scene, 1, {0.5f, 0.25f, 0})));
  expect_mean(mean_of(run(scene).picture), exp_of({-1, -0.5, 0}), 1e-4);
  Medium smoke;
  smoke.absorption = {2, 0, 1};
  add_object(scene, SphereShape{{0, 0, 0}, 0.5}, add_interior(scene, smoke));
  expect_mean(mean_of(run(scene).picture), exp_of({-1.75, -0.375, -0.5}), 1e-4);
  scene.camera.projection = Projection::orthographic, scene.camera.height = 1e-4;
  expect_mean(mean_of(run(scene).picture), exp_of({-1.75, -0.375, -0.5}), 1e-3);
  // The glass lies in water, which has the lowest of three priorities.
  add_object(scene, PlaneShape{{0, 1, 0}, 1}, add_material(scene, filled(scene, 1, {0.1f, 0.1f, 0.1f}, 0)));
  scene.materials[1].priority = 1, scene.materials[2].priority = 2;
  expect_mean(mean_of(run(scene).picture), exp_of({-2.55, -1.175, -1.3}), 1e-3);
}

/// A camera in a ball of radius 1 around the origin that absorbs and gives off light as `medium` does.
Scene inside_ball(Material ball, const Medium& medium, const Vec3d& from, const Vec3d& at) {
  Scene scene = medium_scene(256, 16);
  scene.camera.from = from, scene.camera.at = at;
  scene.media.push_back(medium);
  ball.interior = 0;
  add_object(scene, SphereShape{{0, 0, 0}, 1}, add_material(scene, ball));
  return scene;
}

/// Glass by Phong's model and the principled one.
std::vector<Material> clear_glasses(float ior) {
  Material principled = diffuse({1, 1, 1});
  principled.principled.emplace();
  PrincipledParameters& p = principled.principled->parameters;
  p.base_color = {1, 1, 1}, p.transmission = 1, p.roughness = 0, p.ior = ior;
  return {glass(ior), principled};
}

// Seen from the centre, light comes along the normal, from before the camera and from behind it. Radiance
// keeps its value across the surface but for Fresnel's reflectance F: before, behind, before, ... count (1 -
// F) F^k after the lengths 1, 3, 5, ... within the glass.
TEST(Dielectrics, GlassAroundTheCameraReflectsInside) {
  constexpr double kIor = 1.5, f = 0.04;
  for (const Material& ball : clear_glasses(kIor)) {
    Medium medium;
    medium.absorption = {0, 0.25f, 1};
    Scene scene = inside_ball(ball, medium, {0, 0, 0}, {0, 0, -1});
    const Vec3d before{1, 0.5, 2}, behind{8, 16, 32};
    add_object(scene, PlaneShape{{0, 0, 1}, -10}, add_material(scene, glowing(Color(before))));
    add_object(scene, PlaneShape{{0, 0, -1}, -10}, add_material(scene, glowing(Color(behind))));
    Vec3d want;
    for (int c = 0; c < 3; ++c) {
      const double through = std::exp(-static_cast<double>(medium.absorption[c])),
                   back = f * through * through;
      want[c] = (1 - f) * through * (before[c] + behind[c] * back) / (1 - back * back);
    }
    expect_mean(mean_of(run(scene).picture), want, 5e-3);
  }
}

// Away from the centre rays meet the surface again and again at the same angle, here with the sines 0.6 and
// 0.8. The critical one is 2/3: beyond it nothing from outside is seen, only what the glass itself gives off.
TEST(Dielectrics, GlassAroundTheCameraReflectsAllBeyondTheCriticalAngle) {
  for (const Material& ball : clear_glasses(1.5f)) {
    Medium medium;
    medium.absorption = {1, 0.75f, 2}, medium.emission = {0.25f, 0, 1};
    const Vec3d glow{0.25, 0, 0.5};
    for (const double sine : {0.6, 0.8}) {
      Scene scene = inside_ball(ball, medium, {sine, 0, 0}, {sine, 1, 0});
      scene.background = {1, 2, 3};
      const double cosine = std::sqrt(1 - sine * sine), f = fresnel(cosine, 1 / 1.5);
      EXPECT_EQ(f == 1, sine > 2 / 3.0);
      Vec3d want;
      for (int c = 0; c < 3; ++c) {
        const double half = std::exp(-cosine * static_cast<double>(medium.absorption[c])),
                     chord = half * half;
        const double outside = (1 - f) * half / (1 - f * chord);
        const double own = (1 - half) + half * f * (1 - chord) / (1 - f * chord);
        want[c] = static_cast<double>(scene.background[c]) * outside + glow[c] * own;
      }
      expect_mean(mean_of(run(scene).picture), want, 5e-3);
    }
  }
}

// Rough glass around the camera keeps the light of a white sky, but for the errors of its tables.
TEST(Dielectrics, RoughGlassAroundTheCameraIsWhite) {
  Material rough = clear_glasses(1.5f)[1];
  rough.principled->parameters.roughness = 0.5f;
  Scene scene = inside_ball(rough, {}, {0, 0, 0}, {0, 0, -1});
  scene.integrator.depth = 64;
  scene.background = {1, 1, 1};
  const Mean mean = mean_of(run(scene).picture);
  EXPECT_NEAR(mean.value.x, 1, 0.02 + 3 * mean.error.x);
  EXPECT_LE(mean.value.x, 1 + 3 * mean.error.x);
}

// An orthographic camera whose view is partly inside: each ray begins where its place is.
TEST(Dielectrics, EachPlaceOfTheCameraHasItsSolids) {
  Scene scene = bare_scene(2);
  scene.integrator.kind = IntegratorKind::path;
  scene.camera.projection = Projection::orthographic, scene.camera.height = 2;
  scene.camera.from = {0, 0, 0}, scene.camera.at = {0, 0, -1};
  add_object(scene, PlaneShape{{0, 0, 1}, -10}, add_material(scene, glowing({1, 1, 1})));
  Medium smoke;
  smoke.absorption = {1, 1, 1};
  add_object(scene, BoxShape{{0.01, -5, -1}, {5, 5, 1}}, add_interior(scene, smoke));
  const Picture picture = run(scene).picture;
  for (std::uint32_t y = 0; y < 2; ++y) {
    EXPECT_NEAR(value(picture, "R", 0, y), 1, 1e-5f);
    EXPECT_NEAR(value(picture, "R", 1, y), std::exp(-1.0f), 1e-4f);
  }
}

// Whitted's glass attenuates by Beer's law, with and without data layers, which take another way; boundaries
// without a surface are invisible to it.
TEST(Interiors, WhittedAttenuatesLightInGlass) {
  Scene scene = bare_scene(4);
  scene.camera.from = {0, 0, 5}, scene.camera.fov = 0.001;
  add_object(scene, PlaneShape{{0, 0, 1}, -10}, add_material(scene, glowing({1, 1, 1})));
  add_object(scene, SphereShape{}, add_material(scene, filled(scene, 1, {0.5f, 1, 0})));
  Material invisible = diffuse({1, 1, 1});
  invisible.surface = false;
  add_object(scene, SphereShape{{0, 0, 0}, 3}, add_material(scene, invisible));
  for (const bool layers : {true, false}) {
    const Picture picture = run(scene, [&](RenderOptions& o) { o.data_layers = layers; }).picture;
    const Color seen = color(picture, 2, 2);
    EXPECT_NEAR(seen.x, std::exp(-1.0f), 1e-5f);
    EXPECT_NEAR(seen.y, std::exp(-2.0f), 1e-5f);
    EXPECT_EQ(seen.z, 1);
    EXPECT_EQ(value(picture, "A", 2, 2), 1);
  }
  // From inside, too.
  scene.camera.from = {0, 0, 0}, scene.camera.at = {0, 0, -1};
  for (const bool layers : {true, false}) {
    const Picture picture = run(scene, [&](RenderOptions& o) { o.data_layers = layers; }).picture;
    EXPECT_NEAR(color(picture, 2, 2).y, std::exp(-1.0f), 1e-5f);
    EXPECT_EQ(value(picture, "A", 2, 2), 1);
  }
}

}  // namespace
}  // namespace oktett::dielectrics_test
