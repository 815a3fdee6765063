/// \file Lamps that also scatter light: they are not lit by themselves, whatever rounding does to the places
/// where rays meet them.

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/transform.h"
#include "tests/render/test_scenes.h"

namespace oktett::own_light_test {
namespace {

using namespace test;

/// A lamp of radiance 1 that gives back 4/5 of the light that it receives.
Material lamp(bool both_sides = true) {
  Material m = diffuse({0.8f, 0.8f, 0.8f});
  m.emission = {1, 1, 1};
  m.emits_behind = both_sides;
  return m;
}

/// A camera at z = 5 that sees 16 x 16 points of what stands at the origin, and nothing else.
Scene near_view() {
  Scene scene = bare_scene(16);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = 4, scene.integrator.depth = 3;
  scene.camera.from = {0, 0, 5}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 10;
  return scene;
}

void expect_everywhere(const Scene& scene, float radiance, const char* what) {
  const Picture picture = run(scene).picture;
  for (const float x : picture.find("G")->values) ASSERT_EQ(x, radiance) << what;
}

/// A triangle around the origin with texture coordinates.
std::shared_ptr<TriangleMesh> triangle_mesh() {
  auto mesh = std::make_shared<TriangleMesh>();
  for (const Vec3f& p : {Vec3f{-9, -9, 0}, Vec3f{9, -9, 0}, Vec3f{0, 9, 0}}) mesh->positions.push_back(p);
  for (const Vec2f& uv : {Vec2f{-8.5f, 0}, Vec2f{9.5f, 0}, Vec2f{0.5f, 1}}) mesh->uvs.push_back(uv);
  for (const std::uint32_t k : {0u, 1u, 2u}) mesh->indices.push_back(k), mesh->uv_indices.push_back(k);
  return mesh;
}

const Affine kTurned = Affine::rotation({0.3, 0.5, 0.1}, 35);

/// The lamps that are flat, turned so that no float lies exactly in their plane.
std::vector<std::pair<const char*, Shape>> flat_lamps() {
  return {{"triangle", MeshShape{triangle_mesh(), {}, false}},
          {"two triangles", MeshShape{parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), {}, false}},
          {"disk", DiskShape{{0, 0, 0}, {0, 0, 1}, 3}},
          {"rectangle", PolygonShape{{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}}}}};
}

TEST(OwnLight, FlatLampsDoNotLightThemselves) {
  for (const auto& [name, shape] : flat_lamps()) {
    Scene scene = near_view();
    add_object(scene, shape, add_material(scene, lamp()), kTurned);
    expect_everywhere(scene, 1, name);
  }
}

TEST(OwnLight, DarkSidesStayDark) {
  for (const auto& [name, shape] : flat_lamps()) {
    Scene scene = near_view();
    scene.camera.from = {0, 0, -5};
    add_object(scene, shape, add_material(scene, lamp(false)), kTurned);
    expect_everywhere(scene, 0, name);
  }
  Scene scene = near_view();
  scene.camera.from = {0.2, 0.1, 0.3};
  add_object(scene, SphereShape{{0.1, 0.2, 0.1}, 3}, add_material(scene, lamp(false)));
  expect_everywhere(scene, 0, "inside of a sphere");
}

// These are shaded one by one. Where the texture is black, no light comes from the bright rest.
TEST(OwnLight, TexturedLampsDoNotLightThemselves) {
  class HalfBlack : public TextureSampler {
   public:
    Color color(std::uint32_t, Vec2f uv, Vec2f, Vec2f) const override {
      return uv.x < 0.5f ? Color{0, 0, 0} : Color{1, 1, 1};
    }
    float value(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return 1; }
  };
  const HalfBlack textures;
  Scene scene = near_view();
  Material m = lamp();
  m.emission_texture = 0;
  add_object(scene, MeshShape{triangle_mesh(), {}, false}, add_material(scene, m), kTurned);
  const Picture picture = run(scene, [&](RenderOptions& o) { o.textures = &textures; }).picture;
  int black = 0, bright = 0;
  for (std::uint32_t y = 0; y < 16; ++y)
    for (std::uint32_t x = 0; x < 16; ++x) {
      const float left = value(picture, "u", x, y);
      if (std::abs(left - 0.5f) < 0.06f) continue;  // pixels with both
      ASSERT_EQ(value(picture, "G", x, y), left < 0.5f ? 0.0f : 1.0f) << left;
      ++(left < 0.5f ? black : bright);
    }
  EXPECT_GT(black, 50);
  EXPECT_GT(bright, 50);
}

TEST(OwnLight, SpheresAreNotLitByThemselvesFromOutside) {
  for (const double radius : {1.0, 1e-3, 1e4}) {
    Scene scene = near_view();
    scene.camera.from = Vec3d{0.3, 0.2, 5} * radius;
    add_object(scene, SphereShape{Vec3d{0.1, 0.2, 0.05} * radius, radius}, add_material(scene, lamp()));
    expect_everywhere(scene, 1, "sphere");
  }
}

// Within a sphere each bounce finds the same light again: 1 + 0.8 + 0.64 + ...
TEST(OwnLight, SpheresLightThemselvesFromInside) {
  for (const unsigned depth : {1u, 2u, 64u}) {
    Scene scene = near_view();
    scene.integrator.depth = depth, scene.integrator.samples = 256;
    scene.camera.from = {0.2, 0.1, 0.3};
    add_object(scene, SphereShape{{0.1, 0.2, 0.1}, 3}, add_material(scene, lamp()));
    const Picture picture = run(scene).picture;
    double mean = 0;
    for (const float x : picture.find("G")->values) mean += static_cast<double>(x) / 256;
    EXPECT_NEAR(mean, (1 - std::pow(0.8, depth + 2)) / 0.2, 0.01) << depth;
  }
}

}  // namespace
}  // namespace oktett::own_light_test
