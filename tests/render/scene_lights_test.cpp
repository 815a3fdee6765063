/// \file Which emitter a hit of a lamp is part of.
#include "render/scene_lights.h"

#include <gtest/gtest.h>

#include "render/geometry.h"
#include "tests/render/test_scenes.h"

namespace oktett::scene_lights_test {
namespace {

using namespace test;

TEST(SceneLights, NamesTheEmitterOfAHit) {
  Scene scene = bare_scene();
  scene.integrator.kind = IntegratorKind::path;
  const std::uint32_t lamp = add_material(scene, glowing({1, 1, 1})),
                      dark = add_material(scene, diffuse({1, 1, 1}));
  add_object(scene, SphereShape{{-3, 0, 0}, 1}, dark);
  add_object(scene, SphereShape{{0, 0, 0}, 1}, lamp);
  add_object(scene, SphereShape{{3, 0, 0}, 1}, lamp, Affine::scaling({1, 2, 1}));
  add_object(scene, MeshShape{parallelogram({5, -1, 0}, {2, 0, 0}, {0, 2, 0}), {}, false}, lamp);
  scene.lights = {PointLight{}};
  const World world = build_world(scene);
  const SceneLights lights(scene, world);
  const auto emitter_at = [&](float x) {
    return lights.emitter_at(closest_hit(*world.accel, Ray{{x, 0.5f, 9}, 0, {0, 0, -1}}));
  };
  EXPECT_EQ(lights.set().emitters().size(), 3u) << "the light, a ball and a rectangle";
  EXPECT_EQ(emitter_at(-3), kNoId);
  EXPECT_EQ(emitter_at(0), 1u);
  EXPECT_EQ(emitter_at(3), kNoId) << "an ellipsoid is not sampled";
  EXPECT_EQ(emitter_at(5.1f), 2u) << "one triangle of the rectangle";
  EXPECT_EQ(emitter_at(6.9f), 2u) << "the other";
}

// Two materials may be in two light groups, even if their light is the same.
TEST(SceneLights, HalvesOfTwoMaterialsStayTwoLamps) {
  for (const bool same : {true, false}) {
    Scene scene = bare_scene();
    scene.integrator.kind = IntegratorKind::path;
    auto mesh = parallelogram({5, -1, 0}, {2, 0, 0}, {0, 2, 0});
    for (const int slot : {0, same ? 0 : 1}) mesh->material_slots.push_back(static_cast<std::uint16_t>(slot));
    MeshShape shape;
    shape.mesh = mesh;
    shape.slot_materials = {add_material(scene, glowing({1, 1, 1})), add_material(scene, glowing({1, 1, 1}))};
    add_object(scene, shape, kNoId);
    const World world = build_world(scene);
    EXPECT_EQ(SceneLights(scene, world).set().emitters().size(), same ? 1u : 2u);
  }
}

// Rectangles among other triangles: each hit finds the emitter that it is part of.
TEST(SceneLights, TrianglesOfAMeshAreJoinedOnlyToRectangles) {
  Scene scene = bare_scene();
  scene.integrator.kind = IntegratorKind::path;
  auto mesh = std::make_shared<TriangleMesh>();
  for (const Vec3f& p :
       {Vec3f{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2.5f, 1, 0}, {3, 0, 0}, {4, 1, 0}})
    mesh->positions.push_back(p);
  // A triangle, a rectangle, two triangles that make a kite-like shape, and the half of a rectangle.
  for (const std::uint32_t i : {1, 4, 2, 0, 1, 2, 0, 2, 3, 4, 6, 5, 6, 7, 5, 0, 1, 2})
    mesh->indices.push_back(i);
  for (const std::uint16_t slot : {0, 0, 0, 0, 0, 1}) mesh->material_slots.push_back(slot);
  MeshShape shape;
  shape.mesh = mesh, shape.smooth = false;
  shape.slot_materials = {add_material(scene, glowing({1, 1, 1})), add_material(scene, glowing({2, 2, 2}))};
  add_object(scene, shape, kNoId);
  const World world = build_world(scene);
  const SceneLights lights(scene, world);
  const auto emitter_at = [&](float x, float y) {
    return lights.emitter_at(closest_hit(*world.accel, Ray{{x, y, 9}, 0, {0, 0, -1}}));
  };
  EXPECT_EQ(lights.set().emitters().size(), 5u);
  EXPECT_EQ(emitter_at(1.3f, 0.1f), 0u);
  EXPECT_EQ(emitter_at(0.1f, 0.9f), 1u) << "the half that nothing covers";
  EXPECT_EQ(emitter_at(2.5f, 0.5f), 2u);
  EXPECT_EQ(emitter_at(3.2f, 0.5f), 3u);
}

/// A diffuse surface, a lamp, and a lamp with holes, which is not sampled.
void add_dark_lamp_and_lace(Scene& scene) {
  Material lace = glowing({1, 1, 1});
  lace.opacity = 0.5f;
  for (const Material& m : {diffuse({1, 1, 1}), glowing({1, 1, 1}), lace}) add_material(scene, m);
}

// Five triangles at x = 0, 2, ..., 8, none beside another; those at 2 and 6 are lamps. Instances show them as
// they are, unless they have a material of their own.
TEST(SceneLights, OnlySlotsThatGlowAreLamps) {
  Scene scene = bare_scene();
  scene.integrator.kind = IntegratorKind::path;
  add_dark_lamp_and_lace(scene);
  auto mesh = std::make_shared<TriangleMesh>();
  for (std::uint32_t k = 0; k < 5; ++k) {
    const float x = 2 * static_cast<float>(k);
    for (const Vec3f& p : {Vec3f{x, 0, 0}, Vec3f{x + 1, 0, 0}, Vec3f{x, 1, 0}}) mesh->positions.push_back(p);
    for (const std::uint32_t i : {0u, 1u, 2u}) mesh->indices.push_back(3 * k + i);
  }
  for (const std::uint16_t slot : {0, 1, 2, 1, 0}) mesh->material_slots.push_back(slot);
  MeshShape shape;
  shape.mesh = mesh, shape.smooth = false, shape.slot_materials = {0, 1, 2};
  add_object(scene, shape, kNoId);
  scene.prototypes.push_back({"triangles", scene.objects});
  add_object(scene, InstanceShape{0}, kNoId, Affine::translation({0, 10, 0}));
  add_object(scene, InstanceShape{0}, 0, Affine::translation({0, 20, 0}));
  add_object(scene, InstanceShape{0}, 1, Affine::translation({0, 30, 0}));
  const World world = build_world(scene);
  const SceneLights lights(scene, world);
  const std::vector<Emitter>& emitters = lights.set().emitters();
  EXPECT_EQ(emitters.size(), 2u + 2 + 0 + 5);
  for (const int row : {0, 1, 2, 3})
    for (const int k : {0, 1, 2, 3, 4}) {
      const float x = 2 * static_cast<float>(k), y = 10 * static_cast<float>(row);
      const std::uint32_t number =
          lights.emitter_at(closest_hit(*world.accel, Ray{{x + 0.25f, y + 0.25f, 9}, 0, {0, 0, -1}}));
      const bool lamp = row == 3 || (row < 2 && k % 2 == 1);
      ASSERT_EQ(number != kNoId, lamp) << row << ' ' << k;
      if (!lamp) continue;
      ASSERT_LT(number, emitters.size());
      const auto* triangle = std::get_if<TriangleEmitter>(&emitters[number]);
      ASSERT_NE(triangle, nullptr);
      EXPECT_EQ(triangle->a, (Vec3f{x, y, 0}));
    }
}

// The same for shapes of one material each, by themselves and in an instance.
TEST(SceneLights, OnlyShapesThatGlowAreLamps) {
  Scene scene = bare_scene();
  scene.integrator.kind = IntegratorKind::path;
  add_dark_lamp_and_lace(scene);
  for (const std::uint32_t material : {0u, 1u, 2u}) {
    const double x = 3.0 * material;
    add_object(scene, SphereShape{{x, 0, 0}, 1}, material);
    add_object(scene, DiskShape{{x, 3, 0}, {0, 0, 1}, 1}, material);
    add_object(scene, PolygonShape{{{x - 1, 5, 0}, {x + 1, 5, 0}, {x + 1, 7, 0}, {x - 1, 7, 0}}}, material);
  }
  scene.prototypes.push_back({"shapes", scene.objects});
  add_object(scene, InstanceShape{0}, kNoId, Affine::translation({0, 20, 0}));
  const World world = build_world(scene);
  const SceneLights lights(scene, world);
  EXPECT_EQ(lights.set().emitters().size(), 6u);
  for (const float row : {0.0f, 3.0f, 6.0f, 20.0f, 23.0f, 26.0f})
    for (const float x : {0.0f, 3.0f, 6.0f}) {
      const Hit hit = closest_hit(*world.accel, Ray{{x + 0.25f, row + 0.25f, 9}, 0, {0, 0, -1}});
      EXPECT_EQ(lights.emitter_at(hit) != kNoId, x == 3) << row << ' ' << x;
    }
}

}  // namespace
}  // namespace oktett::scene_lights_test
