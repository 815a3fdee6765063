/// \file Textures that show what meshes carry.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "core/mesh_geometry.h"
#include "render/look/default_look.h"
#include "render/scene_lights.h"
#include "tests/render/test_scenes.h"

namespace oktett::attribute_texture_test {
namespace {

using test::add_material;
using test::add_object;
using test::bare_scene;

/// A linear function of the place, which weights of corners give again anywhere on a triangle.
Color color_at(const Vec3d& p) {
  return Color(Vec3d{0.5 + 0.3 * p.x, 0.5 - 0.2 * p.y + 0.1 * p.z, 0.5 + 0.4 * p.z});
}
float weight_at(const Vec3d& p) { return static_cast<float>(0.5 + 0.25 * p.x + 0.2 * p.y); }

void add(TriangleMesh& mesh, const char* name, AttributeDomain domain, std::uint32_t components,
         Column<float> values) {
  MeshAttribute a;
  a.name = name, a.domain = domain, a.components = components, a.floats = std::move(values);
  ASSERT_EQ(a.size(), domain_size(mesh, domain));
  mesh.attributes.push_back(std::move(a));
}

/// A ball that carries the functions above at vertices and at corners, and numbers of faces.
std::shared_ptr<TriangleMesh> ball() {
  auto mesh = test::sphere_mesh(7);
  Column<float> colors, corners, faces;
  for (const Vec3f& p : mesh->positions) {
    const Color c = color_at(Vec3d(p));
    for (int k = 0; k < 3; ++k) colors.push_back(c[k]);
    colors.push_back(weight_at(Vec3d(p)));
  }
  for (const std::uint32_t i : mesh->indices) corners.push_back(weight_at(Vec3d(mesh->positions[i])));
  for (std::size_t i = 0; i < mesh->triangle_count(); ++i) faces.push_back(static_cast<float>(i % 7) / 8);
  add(*mesh, "color", AttributeDomain::vertex, 4, std::move(colors));
  add(*mesh, "weight", AttributeDomain::corner, 1, std::move(corners));
  add(*mesh, "part", AttributeDomain::face, 1, std::move(faces));
  return mesh;
}

Texture attribute(const char* name, ImageChannel channel = ImageChannel::red) {
  Texture t;
  t.attribute = name, t.channel = channel;
  return t;
}

enum class Stands { alone, moved, in_prototype, combined };

/// The ball, whose emission the texture multiplies.
struct SeenBall {
  Scene scene = bare_scene(40);
  Affine to_world;
  Picture picture;

  SeenBall(const Texture& texture, IntegratorKind kind, Stands stands,
           Material m = test::glowing({1, 1, 1})) {
    scene.camera.from = {0.4, 0.6, 5};
    scene.integrator.kind = kind;
    scene.textures.push_back(texture);
    if (m.emission_texture == kNoId && m.opacity_texture == kNoId) m.emission_texture = 0;
    MeshShape shape;
    shape.mesh = ball();
    const std::uint32_t material = add_material(scene, m);
    to_world =
        stands == Stands::alone ? Affine() : Affine::rotation({10, 20, 30}) * Affine::scaling({-1, 1.2, 0.9});
    if (stands == Stands::in_prototype) {
      const Affine outer = Affine::rotation({-5, 8, 40});
      add_object(scene, shape, material, outer.inverse() * to_world);
      scene.prototypes.push_back({"", std::move(scene.objects)});
      scene.objects.clear();
      add_object(scene, InstanceShape{0}, kNoId, outer);
    } else if (stands == Stands::combined) {
      auto operands = std::make_shared<std::vector<Object>>(2);
      (*operands)[0].shape = shape, (*operands)[0].material = material, (*operands)[0].transform = to_world;
      (*operands)[1].shape = BoxShape{{-3, -3, -3}, {0.2, 3, 3}}, (*operands)[1].material = material;
      add_object(scene, CsgShape{CsgOp::subtract, operands}, kNoId);
    } else {
      add_object(scene, shape, material, to_world);
    }
    picture = test::run(scene).picture;
  }

  /// Calls f(x, y, place in the ball's own space) for the pixels that show it.
  template <class F>
  int each(const F& f) const {
    int count = 0;
    for (std::uint32_t y = 0; y < 40; ++y)
      for (std::uint32_t x = 0; x < 40; ++x) {
        if (!std::isfinite(test::value(picture, "Z", x, y)) || test::value(picture, "A", x, y) == 0) continue;
        f(x, y, to_world.inverse().point(Vec3d(test::position(picture, x, y))));
        ++count;
      }
    return count;
  }
};

TEST(AttributeTexture, ShowsColoursBetweenCorners) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path})
    for (const Stands stands : {Stands::alone, Stands::moved, Stands::in_prototype}) {
      const SeenBall seen(attribute("color"), kind, stands);
      const int count = seen.each([&](std::uint32_t x, std::uint32_t y, const Vec3d& p) {
        const Color found = test::color(seen.picture, x, y), expected = color_at(p);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 3e-5f) << x << " " << y;
      });
      EXPECT_GT(count, 200);
    }
}

TEST(AttributeTexture, NumbersOfCornersAndFacesAreGrey) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path}) {
    Texture scaled = attribute("weight");
    scaled.gain = 2, scaled.base = -0.25f;
    const SeenBall corners(scaled, kind, Stands::moved);
    corners.each([&](std::uint32_t x, std::uint32_t y, const Vec3d& p) {
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(test::color(corners.picture, x, y)[k], std::max(2 * weight_at(p) - 0.25f, 0.0f), 3e-5f);
    });
    const SeenBall faces(attribute("part"), kind, Stands::in_prototype);
    faces.each([&](std::uint32_t x, std::uint32_t y, const Vec3d&) {
      const std::uint32_t triangle = test::id(faces.picture, "primID.I", x, y);
      EXPECT_EQ(test::value(faces.picture, "R", x, y), static_cast<float>(triangle % 7) / 8);
    });
  }
}

TEST(AttributeTexture, SolidsOfCombinationsShowTheirOwn) {
  const SeenBall seen(attribute("color"), IntegratorKind::whitted, Stands::combined);
  int cut = 0;
  const int count = seen.each([&](std::uint32_t x, std::uint32_t y, const Vec3d& p) {
    const Vec3f at = test::position(seen.picture, x, y);
    // The box has no colours: what it cuts shows white.
    const bool of_box = std::abs(at.x - 0.2f) < 1e-4f;
    cut += of_box ? 1 : 0;
    const Color expected = of_box ? Color{1, 1, 1} : color_at(p);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(test::color(seen.picture, x, y)[k], expected[k], 3e-5f);
  });
  EXPECT_GT(count - cut, 100);
}

TEST(AttributeTexture, ChannelsAreTakenAsNumbers) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path}) {
    Material m = test::glowing({1, 1, 1});
    m.opacity_texture = 0;
    SeenBall seen(attribute("color", ImageChannel::alpha), kind, Stands::alone, m);
    if (kind == IntegratorKind::path) continue;  // holes are chosen at random there
    // Behind a hole stands the ball's other side, so light is at least what the front gives.
    seen.each([&](std::uint32_t x, std::uint32_t y, const Vec3d& p) {
      EXPECT_GE(test::color(seen.picture, x, y).x, weight_at(p) - 3e-5f);
    });
  }
}

TEST(AttributeTexture, LuminanceIsThatOfTheColours) {
  const auto luminance_at = [](const Vec3d& p) {
    const Color c = color_at(p);
    return 0.2126 * double{c.x} + 0.7152 * double{c.y} + 0.0722 * double{c.z};
  };
  Material m;
  m.color = {1, 1, 1}, m.ambient = 1, m.diffuse = m.specular = 0;
  Scene scene = bare_scene(40);
  scene.camera.from = {0.4, 0.6, 5}, scene.ambient_light = {1, 1, 1};
  MeshShape shape;
  shape.mesh = ball();
  auto mesh = std::make_shared<TriangleMesh>(*shape.mesh);
  Column<float> values;
  for (const Vec3f& p : mesh->positions) values.push_back(static_cast<float>(luminance_at(Vec3d(p))));
  add(*mesh, "luminance", AttributeDomain::vertex, 1, std::move(values));
  shape.mesh = mesh;
  m.ambient_texture = m.bump_texture = 0, m.bump_scale = 0.5f;
  add_object(scene, shape, add_material(scene, m));
  scene.textures = {attribute("color", ImageChannel::luminance)};
  const Picture of_colors = test::run(scene).picture;
  scene.textures = {attribute("luminance")};
  const Picture of_numbers = test::run(scene).picture;
  int seen = 0;
  for (std::uint32_t y = 0; y < 40; ++y)
    for (std::uint32_t x = 0; x < 40; ++x) {
      if (test::value(of_colors, "A", x, y) == 0) continue;
      ++seen;
      EXPECT_NEAR(test::color(of_colors, x, y).x, luminance_at(Vec3d(test::position(of_colors, x, y))), 3e-5);
      for (const char* axis : {"N.X", "N.Y", "N.Z"})
        EXPECT_NEAR(test::value(of_colors, axis, x, y), test::value(of_numbers, axis, x, y), 1e-4f);
    }
  EXPECT_GT(seen, 200);
}

TEST(AttributeTexture, WhatHasNoSuchAttributeIsWhite) {
  const SeenBall seen(attribute("colour"), IntegratorKind::path, Stands::moved);
  seen.each([&](std::uint32_t x, std::uint32_t y, const Vec3d&) {
    EXPECT_EQ(test::color(seen.picture, x, y), (Color{1, 1, 1}));
  });
}

TEST(AttributeTexture, TintsMultiplyColoursOnceMore) {
  Scene scene = bare_scene(24);
  scene.camera.from = {0, 0, 5};
  scene.ambient_light = {1, 1, 1};
  scene.textures = {attribute("color"), attribute("weight")};
  Material m = test::diffuse({1, 1, 1});
  m.ambient = 1, m.diffuse = 0;
  m.color_texture = 1, m.tint_texture = 0;
  MeshShape shape;
  shape.mesh = ball();
  add_object(scene, shape, add_material(scene, m));
  const Picture picture = test::run(scene).picture;
  for (std::uint32_t x = 8; x < 16; ++x) {
    const Vec3d p(test::position(picture, x, 12));
    const Color expected = color_at(p) * weight_at(p);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(test::color(picture, x, 12)[k], expected[k], 3e-5f);
  }
}

TEST(AttributeTexture, LampsGiveTheLightOfTheirColours) {
  Scene scene = bare_scene();
  scene.integrator.kind = IntegratorKind::path;
  scene.textures.push_back(attribute("color"));
  Material m = test::glowing({1, 1, 1});
  m.emission_texture = 0;
  MeshShape shape;
  shape.mesh = ball();
  add_object(scene, shape, add_material(scene, m), Affine::rotation({0, 40, 0}));
  const World world = build_world(scene);
  const SceneLights lights(scene, world);
  int compared = 0;
  for (std::uint32_t i = 0; i < world.triangles; ++i) {
    Hit hit;
    hit.item = i;
    LightSample sample;
    sample.emitter = lights.emitter_at(hit), sample.u = 0.25f, sample.v = 0.5f;
    if (sample.emitter == kNoId) continue;
    const TriangleMesh& mesh = *shape.mesh;
    const Vec3d p = corner(mesh, i, 0) * 0.25 + corner(mesh, i, 1) * 0.25 + corner(mesh, i, 2) * 0.5;
    const Color found = lights.texture_at(sample, nullptr), expected = color_at(p);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 1e-6f);
    ++compared;
  }
  EXPECT_GT(compared, 50);
}

TEST(AttributeTexture, MeshesGivenAloneShowTheirColours) {
  Scene scene;
  Object object;
  MeshShape shape;
  shape.mesh = ball();
  object.shape = shape;
  show_colors(scene, object);
  ASSERT_LT(object.material, scene.materials.size());
  EXPECT_EQ(scene.textures.at(scene.materials[object.material].color_texture).attribute, "color");
  // Materials with images keep them.
  scene.materials = {test::diffuse({1, 1, 1}), test::diffuse({1, 1, 1})};
  scene.materials[1].color_texture = 0;
  shape.slot_materials = {0, 1};
  object.shape = shape, object.material = kNoId;
  show_colors(scene, object);
  EXPECT_EQ(object.material, kNoId);
  EXPECT_EQ(scene.materials[0].color_texture, 1u);
  EXPECT_EQ(scene.materials[1].color_texture, 0u);
}

}  // namespace
}  // namespace oktett::attribute_texture_test
