#include <gtest/gtest.h>

#include <cmath>

#include "tests/render/test_scenes.h"

namespace oktett::csg_picture_test {
namespace {

using namespace test;

Object solid(Shape shape, std::uint32_t material, const Affine& transform = {}) {
  Object object;
  object.shape = std::move(shape);
  object.material = material;
  object.transform = transform;
  return object;
}
CsgShape combine(CsgOp op, std::vector<Object> operands) {
  return {op, std::make_shared<const std::vector<Object>>(std::move(operands))};
}

/// Straight and oblique views. In oblique ones, faces that should coincide do so only up to rounding.
const Affine kPlacements[] = {
    {},
    Affine::rotation({25, 31, 8}) * Affine::scaling({0.7, 0.7, 0.7}),
    Affine::translation({0.3, 0.1, 0}) * Affine::rotation({-40, 17, 3}) * Affine::scaling({0.9, -0.6, 0.8})};

/// A floor, two lights, and materials 0 (floor), 1 and 2.
Scene stage() {
  Scene scene = bare_scene(192);
  scene.camera.from = {1.2, 2.1, 4}, scene.camera.at = {0, 0, 0};
  scene.background = {0.2f, 0.3f, 0.4f};
  scene.lights = {PointLight{{3, 5, 4}}, PointLight{{-4, 3, 1}, {0.3f, 0.3f, 0.3f}}};
  const std::uint32_t floor = add_material(scene, diffuse({0.7f, 0.7f, 0.7f}));
  add_material(scene, diffuse({0.9f, 0.3f, 0.2f}));
  add_material(scene, diffuse({0.2f, 0.4f, 0.9f}));
  add_object(scene, PlaneShape{{0, 1, 0}, -1.3}, floor);
  return scene;
}

Picture picture_of(const Shape& shape, std::uint32_t material, const Affine& transform) {
  Scene scene = stage();
  add_object(scene, shape, material, transform);
  return run(scene).picture;
}

/// Pixels whose colours, depths or normals differ by more than `tolerance`.
int different_pixels(const Picture& a, const Picture& b, float tolerance) {
  int count = 0;
  for (std::uint32_t y = 0; y < a.height; ++y)
    for (std::uint32_t x = 0; x < a.width; ++x) {
      bool same = true;
      for (const char* plane : {"R", "G", "B", "Z", "N.X", "N.Y", "N.Z"}) {
        const float p = value(a, plane, x, y), q = value(b, plane, x, y);
        same &= p == q || std::abs(p - q) <= tolerance;
      }
      count += same ? 0 : 1;
    }
  return count;
}

/// A box with a hole of the same height, and one whose drill is longer than that.
TEST(CsgPicture, HolesOfTheSameHeightAreOpen) {
  const Object plate = solid(BoxShape{{-1, -0.4, -1}, {1, 0.4, 1}}, 1);
  for (const Affine& place : kPlacements) {
    const auto drilled = [&](double height) {
      const Object drill = solid(BoxShape{{-0.5, -height, -0.5}, {0.5, height, 0.5}}, 2);
      return picture_of(combine(CsgOp::subtract, {plate, drill}), kNoId, place);
    };
    EXPECT_EQ(different_pixels(drilled(0.4), drilled(0.8), 1e-6f), 0);
  }
}

/// A solid less itself is empty, for every kind of solid.
TEST(CsgPicture, NothingIsLeftOfASolidWithoutItself) {
  const Scene empty = stage();
  const Picture expected = run(empty).picture;
  const Shape shapes[] = {BoxShape{}, SphereShape{}, ExactShape{TorusShape{0.8, 0.3}},
                          ExactShape{CylinderShape{}},
                          MeshShape{sphere_mesh(12), {}, true, TriangleTest::watertight}};
  for (const Affine& place : kPlacements)
    for (const Shape& shape : shapes) {
      const Picture left =
          picture_of(combine(CsgOp::subtract, {solid(shape, 1), solid(shape, 2)}), kNoId, place);
      EXPECT_EQ(different_pixels(left, expected, 0), 0);
    }
}

/// Two halves of a ball: the plane between them is invisible, from outside and through glass.
TEST(CsgPicture, HalvesMakeAWhole) {
  const auto ball = [](std::uint32_t material) {
    const auto half = [&](double up) {
      return solid(combine(CsgOp::intersect, {solid(SphereShape{}, material),
                                              solid(PlaneShape{{0, up, 0.3 * up}, 0}, material)}),
                   kNoId);
    };
    return combine(CsgOp::unite, {half(1), half(-1)});
  };
  for (const Affine& place : kPlacements) {
    const Picture whole = picture_of(combine(CsgOp::unite, {solid(SphereShape{}, 1)}), kNoId, place);
    EXPECT_EQ(different_pixels(picture_of(ball(1), kNoId, place), whole, 1e-6f), 0);
  }
}

/// Glass boxes side by side: light passes the common face as if there were none.
TEST(CsgPicture, GlassHasNoSeams) {
  for (const Affine& place : kPlacements) {
    const auto picture = [&](std::vector<Object> parts) {
      Scene scene = stage();
      scene.integrator.depth = 8;
      const std::uint32_t clear = add_material(scene, glass(1.5f));
      for (Object& part : parts) part.material = clear;
      add_object(scene, combine(CsgOp::unite, std::move(parts)), kNoId, place);
      return run(scene).picture;
    };
    const Picture one = picture({solid(BoxShape{{-1, -0.6, -0.5}, {1, 0.6, 0.5}}, 0)});
    const Picture two = picture({solid(BoxShape{{-1, -0.6, -0.5}, {0.2, 0.6, 0.5}}, 0),
                                 solid(BoxShape{{0.2, -0.6, -0.5}, {1, 0.6, 0.5}}, 0)});
    EXPECT_EQ(different_pixels(one, two, 1e-3f), 0);
  }
}

/// The same bits on every instruction set and number of threads.
TEST(CsgPicture, IsTheSameEverywhere) {
  Scene scene = stage();
  scene.integrator.samples = 2;
  const std::uint32_t clear = add_material(scene, glass(1.4f));
  const Object cube =
      solid(combine(CsgOp::intersect,
                    {solid(BoxShape{{-0.75, -0.75, -0.75}, {0.75, 0.75, 0.75}}, 1), solid(SphereShape{}, 2)}),
            kNoId);
  const Object bore = solid(ExactShape{CylinderShape{{0, -2, 0}, {0, 2, 0}, 0.4}}, clear);
  add_object(scene, combine(CsgOp::subtract, {cube, bore}), kNoId, kPlacements[1]);
  const MeshShape mesh{sphere_mesh(16), {}, true, TriangleTest::watertight};
  add_object(scene,
             combine(CsgOp::subtract, {solid(mesh, clear), solid(SphereShape{{0.4, 0.4, 0.4}, 0.8}, 1)}),
             kNoId, Affine::translation({-1.4, 0, 0.4}) * Affine::scaling({0.6, 0.6, 0.6}));
  const Picture expected = run(scene).picture;
  for (const Isa isa : available_isas())
    for (const unsigned threads : {1u, 2u}) {
      const Picture p = run(scene, [&](RenderOptions& o) { o.isa = isa, o.threads = threads; }).picture;
      EXPECT_TRUE(same_bytes(p, expected)) << to_string(isa);
    }
}

}  // namespace
}  // namespace oktett::csg_picture_test
