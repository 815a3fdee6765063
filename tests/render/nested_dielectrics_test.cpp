/// \file Nested dielectrics: solids that overlap, and their priorities.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "tests/render/medium_support.h"

namespace oktett::nested_dielectrics_test {
namespace {

using namespace test;

CsgShape difference(const Object& a, const Object& b) {
  return {CsgOp::subtract, std::make_shared<const std::vector<Object>>(std::vector{a, b})};
}

Object object(Shape shape, std::uint32_t material) {
  Object o;
  o.shape = std::move(shape), o.material = material;
  return o;
}

/// A small view of a block of glass around another, under light of several colours from several sides.
Scene block_scene() {
  Scene scene = bare_scene(12);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = 256, scene.integrator.depth = 24;
  scene.camera.from = {0.7, 1.1, 4}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 35;
  scene.background = {0.2f, 0.3f, 0.4f};
  add_object(scene, PlaneShape{{0, 0, 1}, -6}, add_material(scene, glowing({1, 0.2f, 0.1f})));
  add_object(scene, PlaneShape{{1, 0, 0}, -6}, add_material(scene, glowing({0.1f, 2, 0.1f})));
  return scene;
}

/// Pictures agree pixel by pixel within what their samples scatter.
void expect_same_light(const Picture& a, const Picture& b) {
  int far = 0, count = 0;
  Vec3d sums{0, 0, 0};
  for (std::uint32_t y = 0; y < a.height; ++y)
    for (std::uint32_t x = 0; x < a.width; ++x) {
      const char *names[] = {"R", "G", "B"}, *variances[] = {"Variance.R", "Variance.G", "Variance.B"};
      for (int c = 0; c < 3; ++c) {
        const float u = value(a, names[c], x, y), v = value(b, names[c], x, y);
        const float error = std::sqrt(value(a, variances[c], x, y) + value(b, variances[c], x, y));
        sums[c] += static_cast<double>(u - v) / (a.width * a.height);
        far += std::abs(u - v) > 4 * error + 1e-3f ? 1 : 0, ++count;
      }
    }
  EXPECT_LE(far, count / 100);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sums[c], 0, 0.005) << c;
}

// Liquid in glass: the liquid overlaps the wall, and the wall, of higher priority, wins. The same picture as
// with interfaces that touch each other exactly, where the inner one bends light by the ratio of the indices.
TEST(NestedDielectrics, OverlappingSolidsMatchExactInterfaces) {
  const BoxShape outer{{-1, -1, -1}, {1, 1, 1}}, cavity{{-0.6, -0.6, -0.6}, {0.6, 0.6, 0.6}};
  Scene exact = block_scene();
  exact.materials.reserve(8);
  const std::uint32_t wall = add_material(exact, filled(exact, 1.5f, {0.1f, 0, 0.3f}));
  add_object(exact, outer, wall);
  add_object(exact, cavity, add_material(exact, filled(exact, 1.33f / 1.5f, {0.5f, 1, 0})));

  Scene overlapping = block_scene();
  const std::uint32_t hollow = add_material(overlapping, filled(overlapping, 1.5f, {0.1f, 0, 0.3f}, 2));
  add_object(overlapping, difference(object(outer, hollow), object(cavity, hollow)), hollow);
  add_object(overlapping, BoxShape{{-0.7, -0.8, -0.7}, {0.8, 0.7, 0.7}},
             add_material(overlapping, filled(overlapping, 1.33f, {0.5f, 1, 0}, 1)));
  const Picture want = run(exact).picture, got = run(overlapping).picture;
  expect_same_light(want, got);

  // The other way round: the liquid of higher priority carves its place out of a massive block.
  Scene carved = block_scene();
  add_object(carved, outer, add_material(carved, filled(carved, 1.5f, {0.1f, 0, 0.3f}, 1)));
  add_object(carved, cavity, add_material(carved, filled(carved, 1.33f, {0.5f, 1, 0}, 2)));
  expect_same_light(want, run(carved).picture);

  // Without priorities the overlap gives another picture, so the test can tell.
  for (Material& m : overlapping.materials) m.priority = kNoPriority;
  double difference = 0;
  const Picture wrong = run(overlapping).picture;
  for (std::uint32_t i = 0; i < 12; ++i)
    difference += std::abs(static_cast<double>(value(wrong, "R", i, 6) - value(want, "R", i, 6)));
  EXPECT_GT(difference, 0.1);
}

/// Answers all questions for numbers with a half.
class HalfTextures final : public TextureSampler {
 public:
  Color color(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return {0.5f, 0.5f, 0.5f}; }
  float value(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return 0.5f; }
};

// Glass in water by priorities. An index of refraction that is a texture of half of 3 bends light as 1.5
// does, bit for bit, for solids that light enters, for those around them, and for those that the camera is
// in.
TEST(NestedDielectrics, TexturedIndicesCountAsTheirValues) {
  const HalfTextures half;
  for (const bool inside : {false, true})
    for (const std::size_t textured : {0u, 1u}) {
      Picture pictures[3];
      for (int variant = 0; variant < 3; ++variant) {
        Scene scene = block_scene();
        scene.integrator.samples = 4, scene.integrator.depth = 6;
        if (inside) scene.camera.from = {0.1, 0.2, 0.3};
        scene.textures.emplace_back();
        for (const std::size_t n : {0u, 1u}) {
          Material m;
          PrincipledParameters& p = m.principled.emplace().parameters;
          p.base_color = {1, 1, 1}, p.transmission = 1, p.roughness = 0;
          p.ior = n == 0 ? 1.5f : 1.25f;
          if (n == textured && variant > 0) p.ior *= 2, m.principled->ior_texture = 0;
          // To show that the test can tell: as if the texture were white.
          if (n == textured && variant == 2) m.principled->ior_texture = kNoId;
          resemble_principled(m);
          m.priority = n == 0 ? 2 : 1;
          const double size = n == 0 ? 0.6 : 1;
          add_object(scene, BoxShape{{-size, -size, -size}, {size, size, size}}, add_material(scene, m));
        }
        pictures[variant] = run(scene, [&](RenderOptions& o) { o.textures = &half; }).picture;
      }
      EXPECT_TRUE(same_bytes(pictures[0], pictures[1])) << textured << inside;
      EXPECT_FALSE(same_bytes(pictures[0], pictures[2])) << textured << inside;
    }
}

// A lamp inside of glass is found by light samples through hidden boundaries as by chance.
TEST(NestedDielectrics, HiddenBoundariesDoNotShadow) {
  Scene scene = medium_scene(64, 3);
  scene.camera.from = {0, 3, 5};
  add_object(scene, DiskShape{{0, 0, 0}, {0, 1, 0}, 0.05}, add_material(scene, diffuse({1, 1, 1})));
  add_object(scene, SphereShape{{0, 3, -1}, 0.3}, add_material(scene, glowing({8, 8, 8})));
  Material around = glass(1.5f), inside = glass(1.2f);
  around.priority = 5, inside.priority = 4;
  add_object(scene, SphereShape{{0, 0, 0}, 30}, add_material(scene, around));
  const Mean clear = mean_of(run(scene).picture);
  add_object(scene, BoxShape{{-1, 1, -3}, {1, 2, 1}}, add_material(scene, inside));
  const Mean hidden = mean_of(run(scene).picture);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(hidden.value[c], clear.value[c], 3 * std::hypot(hidden.error[c], clear.error[c]) + 1e-6);
  EXPECT_LT(hidden.error.x, 3 * clear.error.x) << "the lamp is sampled through the box";
}

// Of solids of the same priority the one that was entered last fills the space. So the boundary where the
// path leaves the other one, within it, does nothing: a slab of glass shows (1 - R) / (1 + R) of the light
// behind it, R = 1/25, also if another solid of index 1 reaches into it.
TEST(NestedDielectrics, OfEqualPrioritiesTheLaterSolidHidesTheEarlier) {
  for (const bool reaches_in : {false, true}) {
    Scene scene = medium_scene(256, 12);
    Material air = glass(1), slab = glass(1.5f);
    air.priority = slab.priority = 1;
    if (reaches_in) add_object(scene, BoxShape{{-9, -9, -0.5}, {9, 9, 1}}, add_material(scene, air));
    add_object(scene, BoxShape{{-9, -9, -2}, {9, 9, 0}}, add_material(scene, slab));
    add_object(scene, PlaneShape{{0, 0, 1}, -3}, add_material(scene, glowing({1, 1, 1})));
    EXPECT_NEAR(mean_of(run(scene).picture).value.x, 0.96 / 1.04, 0.005) << reaches_in;
  }
}

// A lamp of glass in a solid of higher priority is not there.
TEST(NestedDielectrics, HiddenLampsGiveNoLight) {
  for (const int around : {0, 2}) {
    Scene scene = medium_scene(16, 4);
    Material air = glass(1), lamp = glass(1);
    air.priority = around, lamp.priority = 1, lamp.emission = {5, 5, 5};
    add_object(scene, BoxShape{{-9, -9, -0.5}, {9, 9, 4}}, add_material(scene, air));
    add_object(scene, SphereShape{{1, 0, 0.5}, 0.4}, add_material(scene, lamp));
    add_object(scene, DiskShape{{0, 0, -0.4}, {0, 0, 1}, 9}, add_material(scene, diffuse({1, 1, 1})));
    const double light = mean_of(run(scene).picture).value.x;
    if (around > 1)
      EXPECT_EQ(light, 0);
    else
      EXPECT_GT(light, 0.1);
  }
}

}  // namespace
}  // namespace oktett::nested_dielectrics_test
