/// \file Pictures without light: colours, uv, positions, ids, facing and wires.

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>

#include "accel/hit_place.h"
#include "render/geometry.h"
#include "tests/render/test_scenes.h"

namespace oktett::flat_integrators_test {
namespace {

using namespace test;

/// A square of side 4 before the camera, as two triangles with uv, twice as wide as high in uv.
std::shared_ptr<TriangleMesh> square() {
  auto mesh = std::make_shared<TriangleMesh>();
  for (const Vec3f& p : {Vec3f{-2, -2, 0}, Vec3f{2, -2, 0}, Vec3f{2, 2, 0}, Vec3f{-2, 2, 0}})
    mesh->positions.push_back(p);
  for (const Vec2f& p : {Vec2f{0, 0}, Vec2f{2, 0}, Vec2f{2, 1}, Vec2f{0, 1}}) mesh->uvs.push_back(p);
  for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u})
    mesh->indices.push_back(i), mesh->uv_indices.push_back(i);
  return mesh;
}

Scene flat_scene(IntegratorKind kind, const Affine& transform = {}) {
  Scene scene = bare_scene(40);
  scene.integrator.kind = kind;
  scene.camera.projection = Projection::orthographic;
  scene.camera.height = 4;
  MeshShape shape;
  shape.mesh = square();
  add_object(scene, shape, add_material(scene, diffuse({0.2f, 0.4f, 0.6f})), transform);
  return scene;
}

TEST(FlatIntegrators, AlbedoUvAndPosition) {
  const Picture albedo = run(flat_scene(IntegratorKind::albedo)).picture;
  EXPECT_EQ(color(albedo, 3, 30), (Color{0.2f, 0.4f, 0.6f}));
  for (const bool layers : {true, false}) {
    const auto change = [&](RenderOptions& o) { o.data_layers = layers; };
    const Picture uv = run(flat_scene(IntegratorKind::uv), change).picture;
    // Pixel (5, 0) is at x = -2 + 0.55 and y = 2 - 0.05.
    EXPECT_NEAR(value(uv, "R", 5, 0), 2 * 0.55 / 4, 1e-5);
    EXPECT_NEAR(value(uv, "G", 5, 0), 1 - 0.05 / 4, 1e-5);
    // u of 1.5 and more wraps around.
    EXPECT_NEAR(value(uv, "R", 35, 0), 2 * 3.55 / 4 - 1, 1e-5);
    const Picture position = run(flat_scene(IntegratorKind::position), change).picture;
    EXPECT_NEAR(value(position, "R", 5, 0), 0.55 / 4, 1e-5);
    EXPECT_NEAR(value(position, "G", 5, 0), 1 - 0.05 / 4, 1e-5);
    // The scene has no depth.
    EXPECT_EQ(value(position, "B", 5, 0), 0);
  }
}

/// It is seen by the direction, directly and in mirrors, also beside an environment that is black.
TEST(FlatIntegrators, ABackgroundMayBeAPattern) {
  Scene scene = bare_scene(8);
  scene.camera.from = {0, 0, 5}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 90;
  Texture texture;
  texture.pattern.emplace();
  texture.pattern->pattern = GradientPattern{{-1, 0, 0}, {1, 0, 0}};
  scene.textures = {texture};
  scene.background = {1, 1, 0.5f}, scene.background_texture = 0;
  for (const IntegratorKind kind : {IntegratorKind::albedo, IntegratorKind::whitted, IntegratorKind::path}) {
    scene.integrator.kind = kind;
    const Picture picture = run(scene).picture;
    for (std::uint32_t x = 0; x < 8; ++x) {
      // The middle of the pixel, but for path tracing, which takes a place in it.
      const double slack = kind == IntegratorKind::path ? 0.07 : 1e-6;
      const double right = (x + 0.5) / 4 - 1, down = 3.5 / 4 - 1;
      const double expected = 0.5 + 0.5 * right / std::sqrt(right * right + down * down + 1);
      EXPECT_NEAR(value(picture, "R", x, 3), expected, slack) << static_cast<int>(kind) << " " << x;
      EXPECT_NEAR(value(picture, "B", x, 3), expected / 2, slack);
    }
  }
  // A mirror in the plane x = 0 shows the same on both sides of it.
  scene.integrator.kind = IntegratorKind::whitted;
  Material mirror = diffuse({0, 0, 0});
  mirror.reflection = 1;
  add_object(scene, PlaneShape{{1, 0, 0}, 0}, add_material(scene, mirror));
  scene.camera.from = {1, 0, 5}, scene.camera.at = {1, 0, 0};
  const Picture picture = run(scene).picture;
  for (std::uint32_t x = 0; x < 3; ++x)
    EXPECT_NEAR(value(picture, "R", x, 3), value(picture, "R", 7 - x, 3), 1e-6) << x;
}

TEST(FlatIntegrators, ObjectsAndPrimitivesHaveColoursOfTheirOwn) {
  Scene scene = flat_scene(IntegratorKind::object);
  add_object(scene, SphereShape{{0, 0, 0}, 1}, 0);
  const Picture objects = run(scene).picture;
  scene.integrator.kind = IntegratorKind::primitive;
  const Picture primitives = run(scene).picture;
  using Rgb = std::tuple<float, float, float>;
  std::set<Rgb> object_colors, primitive_colors;
  for (std::uint32_t y = 0; y < 40; ++y)
    for (std::uint32_t x = 0; x < 40; ++x) {
      const Color a = color(objects, x, y), b = color(primitives, x, y);
      object_colors.insert({a.x, a.y, a.z}), primitive_colors.insert({b.x, b.y, b.z});
    }
  EXPECT_EQ(object_colors.size(), 2u);
  EXPECT_EQ(primitive_colors.size(), 3u);
}

TEST(FlatIntegrators, FacingIsTheCosineAndTellsBacks) {
  Scene scene = flat_scene(IntegratorKind::facing, Affine::rotation({0, 60, 0}));
  EXPECT_NEAR(value(run(scene).picture, "G", 20, 20), 0.5, 1e-6);
  scene.objects[0].transform = Affine::rotation({0, 120, 0});
  const Picture behind = run(scene).picture;
  EXPECT_NEAR(value(behind, "R", 20, 20), 0.5, 1e-6);
  EXPECT_EQ(value(behind, "G", 20, 20), 0);
}

// A line is one pixel wide across its direction, however the triangle is turned and scaled: the diagonal of
// the square takes sqrt(2) pixels of each row.
TEST(FlatIntegrators, WiresAreOnePixelWide) {
  for (const double scale : {1.0, 1e3}) {
    Scene scene = flat_scene(IntegratorKind::wire, Affine::scaling({scale, scale, scale}));
    scene.camera.height = 4 * scale;
    scene.camera.from = {0, 0, 10 * scale};
    scene.integrator.samples = 256;
    const Picture p = run(scene).picture;
    // Away from the border the row holds nothing but the diagonal.
    double dark = 0;
    for (std::uint32_t x = 5; x < 35; ++x) dark += (0.8 - value(p, "R", x, 20)) / 0.78;
    EXPECT_NEAR(dark, std::sqrt(2.0), 0.02);
    // The border is half inside the picture.
    EXPECT_NEAR((0.8 - value(p, "R", 0, 10)) / 0.78, 0.5, 0.02);
  }
}

TEST(FlatIntegrators, ShapesWithoutTrianglesHaveNoWires) {
  Scene scene = bare_scene(21);
  scene.integrator.kind = IntegratorKind::wire;
  add_object(scene, SphereShape{{0, 0, 0}, 1}, add_material(scene, diffuse({1, 1, 1})));
  EXPECT_NEAR(value(run(scene).picture, "R", 10, 10), 0.8, 1e-5);
}

TEST(FlatIntegrators, CornersAreFoundThroughInstances) {
  Scene scene = bare_scene(1);
  MeshShape shape;
  shape.mesh = square();
  scene.prototypes.push_back({"square", {}});
  Object object;
  object.shape = shape;
  object.transform = Affine::translation({1, 0, 0});
  scene.prototypes[0].objects.push_back(object);
  const Affine moved = Affine::translation({0, 3, 0}) * Affine::rotation({0, 0, 90});
  add_object(scene, InstanceShape{0}, kNoId, moved);
  add_object(scene, SphereShape{{0, 30, 0}, 1}, kNoId);
  const World world = build_world(scene);
  const Hit hit = closest_hit(*world.accel, Ray{{0, 3.5f, 5}, 0, {0, 0, -1}});
  const auto corners = triangle_corners(*world.accel, hit);
  ASSERT_TRUE(corners);
  const std::uint32_t primitive = identify(*world.accel, hit).primitive;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d corner(shape.mesh->positions[shape.mesh->indices[3 * primitive + k]]);
    EXPECT_LT(length(Vec3d((*corners)[k]) - moved.point(corner + Vec3d{1, 0, 0})), 1e-6);
  }
  EXPECT_FALSE(triangle_corners(*world.accel, closest_hit(*world.accel, Ray{{0, 30, 5}, 0, {0, 0, -1}})));
}

}  // namespace
}  // namespace oktett::flat_integrators_test
