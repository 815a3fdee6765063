#include <gtest/gtest.h>

#include <cmath>

#include "tests/render/test_scenes.h"

namespace oktett::self_shadow_test {
namespace {

using namespace test;

/// Counts the pixels of a convex body lit from the camera that are black although they face the light. The
/// normal of each pixel comes from the picture.
int black_pixels(Scene scene, const Vec3d& center, double radius, int& lit) {
  scene.camera.from = center + Vec3d{0.3, 0.2, 3} * radius;
  scene.camera.at = center;
  const Vec3d to_light = normalize(Vec3d{0.5, 0.8, 1});
  scene.lights = {DirectionalLight{-to_light, {1, 1, 1}}};
  const Picture p = run(scene).picture;
  int black = 0;
  lit = 0;
  for (std::uint32_t y = 0; y < p.height; ++y)
    for (std::uint32_t x = 0; x < p.width; ++x) {
      if (value(p, "A", x, y) == 0) continue;
      const Vec3d n = normalize(Vec3d{value(p, "N.X", x, y), value(p, "N.Y", x, y), value(p, "N.Z", x, y)});
      if (dot(n, to_light) < 0.02) continue;
      ++lit;
      if (value(p, "R", x, y) < 0.01f) ++black;
    }
  return black;
}

/// Places and sizes of bodies: near and far from the origin, tiny and huge.
struct Place {
  Vec3d center;
  double radius;
};
constexpr Place kPlaces[] = {{{0, 0, 0}, 1},         {{0, 0, 0}, 1e-6},      {{0, 0, 0}, 1e6},
                             {{0, 0, 0}, 1e12},      {{1000, -500, 300}, 1}, {{1e5, 2e5, -3e5}, 10},
                             {{1e6, 1e6, 1e6}, 100}, {{-1e-3, 0, 0}, 1e-5}};

TEST(SelfShadow, SpheresHaveNoSpeckles) {
  for (const Place& place : kPlaces) {
    Scene scene = bare_scene(96);
    add_object(scene, SphereShape{place.center, place.radius}, add_material(scene, diffuse({1, 1, 1})));
    int lit;
    EXPECT_EQ(black_pixels(scene, place.center, place.radius, lit), 0)
        << place.radius << ' ' << place.center.x;
    EXPECT_GT(lit, 1000);
  }
}

TEST(SelfShadow, FlatMeshesHaveNoSpeckles) {
  for (const Place& place : kPlaces) {
    // Facets of a mesh far from the origin have no exact normals, but still do not shadow themselves.
    Scene scene = bare_scene(96);
    const auto mesh = sphere_mesh(12, place.center, place.radius);
    add_object(scene, MeshShape{mesh, {}, false, TriangleTest::watertight},
               add_material(scene, diffuse({1, 1, 1})));
    int lit;
    EXPECT_EQ(black_pixels(scene, place.center, place.radius, lit), 0)
        << place.radius << ' ' << place.center.x;
    EXPECT_GT(lit, 1000);
  }
}

TEST(SelfShadow, TransformedBodiesHaveNoSpeckles) {
  const Affine move =
      Affine::translation({1e4, -2e4, 5e3}) * Affine::rotation({20, 30, 40}) * Affine::scaling({3, 3, 3});
  for (int kind = 0; kind < 3; ++kind) {
    Scene scene = bare_scene(96);
    const std::uint32_t material = add_material(scene, diffuse({1, 1, 1}));
    const MeshShape mesh{sphere_mesh(12), {}, false, TriangleTest::watertight};
    if (kind == 0) add_object(scene, mesh, material, move);
    if (kind == 1) add_object(scene, SphereShape{}, material, move);
    if (kind == 2) {
      Object inside;
      inside.shape = mesh;
      scene.prototypes.push_back({"body", {inside}});
      add_object(scene, InstanceShape{0}, material, move);
    }
    int lit;
    EXPECT_EQ(black_pixels(scene, {1e4, -2e4, 5e3}, 3, lit), 0) << kind;
    EXPECT_GT(lit, 1000) << kind;
  }
}

// A mirror ball in a bright void sees nothing but the void: no reflected ray may meet the ball again.
TEST(SelfShadow, MirrorsDoNotReflectThemselves) {
  for (const Place& place : kPlaces) {
    Scene scene = bare_scene(96);
    scene.camera.from = place.center + Vec3d{0.3, 0.2, 3} * place.radius, scene.camera.at = place.center;
    scene.background = {1, 1, 1};
    scene.integrator.depth = 1;
    add_object(scene, SphereShape{place.center, place.radius}, add_material(scene, mirror()));
    const Picture p = run(scene).picture;
    for (const float v : p.find("R")->values) ASSERT_NEAR(v, 1, 1e-6f) << place.radius;
  }
}

// Clear glass in a bright void loses no ray, whatever its size and place.
TEST(SelfShadow, GlassLosesNoLight) {
  for (const Place& place : kPlaces) {
    Scene scene = bare_scene(64);
    scene.camera.from = place.center + Vec3d{0.3, 0.2, 3} * place.radius, scene.camera.at = place.center;
    scene.background = {1, 1, 1};
    scene.integrator.depth = 2;
    add_object(scene, SphereShape{place.center, place.radius}, add_material(scene, glass(1)));
    const Picture p = run(scene).picture;
    for (const float v : p.find("R")->values) ASSERT_NEAR(v, 1, 1e-6f) << place.radius;
  }
}

}  // namespace
}  // namespace oktett::self_shadow_test
