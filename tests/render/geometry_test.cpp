#include "render/geometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/solids.h"
#include "tests/render/test_scenes.h"

namespace oktett::geometry_test {
namespace {

using namespace test;

/// Two triangles side by side in the plane z = 0, of slots 0 (x < 0) and 1 (x > 0).
std::shared_ptr<TriangleMesh> two_slots() {
  auto mesh = std::make_shared<TriangleMesh>();
  for (const Vec3f& p : {Vec3f{-2, -1, 0}, Vec3f{0, -1, 0}, Vec3f{-1, 2, 0}, Vec3f{2, -1, 0}, Vec3f{1, 2, 0}})
    mesh->positions.push_back(p);
  for (const std::uint32_t i : {0u, 1u, 2u, 1u, 3u, 4u}) mesh->indices.push_back(i);
  mesh->material_slots.push_back(0), mesh->material_slots.push_back(1);
  return mesh;
}

struct Pair {
  Color left, right;
};
Pair left_and_right(const Scene& scene) {
  const Picture p = run(scene).picture;
  const auto albedo = [&](std::uint32_t x) {
    return Color{value(p, "Albedo.R", x, 8), value(p, "Albedo.G", x, 8), value(p, "Albedo.B", x, 8)};
  };
  return {albedo(4), albedo(12)};
}

TEST(Geometry, MaterialsComeFromTheObjectElseTheSlotElseTheDefault) {
  Scene scene = bare_scene(17);
  const Color red{1, 0, 0}, green{0, 1, 0}, blue{0, 0, 1}, neutral = Material{}.color;
  for (const Color& c : {red, green, blue}) add_material(scene, diffuse(c));
  const auto with = [&](std::vector<std::uint32_t> slots, std::uint32_t material) {
    scene.objects.clear();
    add_object(scene, MeshShape{two_slots(), std::move(slots), true, TriangleTest::watertight}, material);
    return left_and_right(scene);
  };
  EXPECT_EQ(with({0, 1}, kNoId).left, red);
  EXPECT_EQ(with({0, 1}, kNoId).right, green);
  EXPECT_EQ(with({0, 1}, 2).left, blue);
  EXPECT_EQ(with({0}, kNoId).right, neutral);
  EXPECT_EQ(with({kNoId, 1}, kNoId).left, neutral);
  EXPECT_EQ(with({}, kNoId).left, neutral);
  EXPECT_EQ(with({}, 77).left, neutral);
}

/// A tetrahedron in slot 0, of which one face may be missing, and a triangle in slot 1.
std::shared_ptr<TriangleMesh> glass_with_label(bool whole) {
  auto mesh = std::make_shared<TriangleMesh>();
  for (const Vec3f& p : {Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, 0, 1}})
    mesh->positions.push_back(p);
  for (const std::uint32_t i : {0u, 2u, 1u, 0u, 1u, 3u, 1u, 2u, 3u, 0u, 3u, 2u, 0u, 1u, 2u})
    mesh->indices.push_back(i);
  for (const std::uint16_t slot : {0, 0, 0, whole ? 0 : 1, 1}) mesh->material_slots.push_back(slot);
  return mesh;
}

// A label on a glass opens the mesh, but not the glass.
TEST(Geometry, GlassBesideOtherFacesHasAnInsideIfItIsClosedByItself) {
  Scene scene = bare_scene(17);
  scene.integrator.kind = IntegratorKind::path;
  Material glass = diffuse({1, 1, 1});
  glass.principled.emplace().parameters.transmission = 1;
  glass.interior = 0;
  scene.media.emplace_back().absorption = {1, 1, 1};
  add_material(scene, glass), add_material(scene, diffuse({1, 0, 0}));
  const auto is_tracked = [&](bool whole, std::vector<std::uint32_t> slots, std::uint32_t material) {
    scene.objects.clear();
    add_object(scene, MeshShape{glass_with_label(whole), std::move(slots), true, TriangleTest::watertight},
               material);
    EXPECT_FALSE(is_solid(scene.objects[0].shape, scene.prototypes));
    const World world = build_world(scene, {});
    EXPECT_EQ(world.has_enclosing_solids, has_inside(scene.objects[0], scene));
    return world.objects[0].solid == 0;
  };
  EXPECT_TRUE(is_tracked(true, {0, 1}, kNoId));
  EXPECT_FALSE(is_tracked(false, {0, 1}, kNoId));
  EXPECT_FALSE(is_tracked(true, {0, 0}, kNoId));
  EXPECT_FALSE(is_tracked(true, {1, 1}, kNoId));
  EXPECT_TRUE(is_tracked(true, {0}, kNoId));
  EXPECT_FALSE(is_tracked(true, {0, 1}, 0));
}

TEST(Geometry, InstancesShowTheirOwnMaterialElseThatInside) {
  Scene scene = bare_scene(17);
  const Color red{1, 0, 0}, blue{0, 0, 1};
  add_material(scene, diffuse(red)), add_material(scene, diffuse(blue));
  Object mesh, inner;
  mesh.shape = MeshShape{two_slots(), {0, 1}, true, TriangleTest::watertight};
  inner.shape = InstanceShape{0};
  scene.prototypes = {{"mesh", {mesh}}, {"nested", {inner}}};
  add_object(scene, InstanceShape{1}, kNoId);
  EXPECT_EQ(left_and_right(scene).left, red);
  EXPECT_EQ(left_and_right(scene).right, blue);
  scene.objects[0].material = 1;
  EXPECT_EQ(left_and_right(scene).left, blue);
  scene.prototypes[1].objects[0].material = 0;
  EXPECT_EQ(left_and_right(scene).left, blue);
  scene.objects[0].material = kNoId;
  EXPECT_EQ(left_and_right(scene).right, red);
}

TEST(Geometry, CountsWhatIsUnique) {
  Scene scene = bare_scene();
  Object mesh;
  mesh.shape = MeshShape{two_slots(), {}, true, TriangleTest::watertight};
  scene.prototypes = {{"mesh", {mesh}}};
  for (int i = 0; i < 10; ++i)
    add_object(scene, InstanceShape{0}, kNoId, Affine::translation({0, 0, 1.0 * i}));
  add_object(scene, SphereShape{}, kNoId);
  const World world = build_world(scene);
  EXPECT_EQ(world.triangles, 2u);
  EXPECT_EQ(world.primitives, 3u);
  EXPECT_EQ(world.meshes.size(), 1u);
  EXPECT_GT(world.geometry_bytes, 0u);
  EXPECT_GT(world.bvh_bytes, 0u);
}

TEST(Geometry, KnowsWhetherMaterialsLetLightPass) {
  const auto world = [](auto&& change) {
    Scene scene = bare_scene();
    Material m;
    change(m);
    add_material(scene, m);
    return build_world(scene);
  };
  const World opaque = world([](Material&) {});
  const World clear = world([](Material& m) { m.transparency = 0.5f; });
  EXPECT_FALSE(opaque.has_holes || opaque.has_clear);
  EXPECT_TRUE(clear.has_clear);
  EXPECT_FALSE(clear.has_holes);
  EXPECT_TRUE(world([](Material& m) { m.opacity = 0.5f; }).has_holes);
  EXPECT_TRUE(world([](Material& m) { m.opacity_texture = 0; }).has_holes);
  EXPECT_TRUE(world([](Material& m) { m.surface = false; }).has_holes);
}

TEST(Geometry, ReferencesThatLeadNowhereAreLeftOut) {
  Scene scene = bare_scene();
  add_object(scene, MeshShape{}, kNoId);
  add_object(scene, InstanceShape{}, kNoId);
  add_object(scene, InstanceShape{3}, kNoId);
  Object itself;
  itself.shape = InstanceShape{0};
  scene.prototypes = {{"loop", {itself}}};
  add_object(scene, InstanceShape{0}, kNoId);
  add_object(scene, SphereShape{{0, 0, 0}, 0}, kNoId);
  add_object(scene, SphereShape{}, kNoId, Affine::scaling({1, 0, 1}));
  const RenderResult r = run(scene);
  EXPECT_EQ(value(r.picture, "A", 8, 8), 0);
}

// A triangle keeps its front under any transform, mirrors included.
TEST(Geometry, TrianglesKeepTheirFront) {
  Scene scene = bare_scene(3);
  const TriangleShape triangle{{{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}}};
  for (const Affine& map : {Affine{}, Affine::scaling({-1, 1, 1}), Affine::scaling({2, 3, 1})}) {
    scene.objects.clear();
    add_object(scene, triangle, kNoId, map);
    EXPECT_NEAR(value(run(scene).picture, "N.Z", 1, 1), 1, 1e-6f);
  }
}

}  // namespace
}  // namespace oktett::geometry_test
