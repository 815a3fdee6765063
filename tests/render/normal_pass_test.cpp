/// \file The normals that pictures show: those that lights see, and those of the true surface.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "render/asked_textures.h"
#include "tests/render/test_scenes.h"

namespace oktett::normal_pass_test {
namespace {

using namespace test;

/// Every image has these normals and is a slope of heights.
class SlopeTextures final : public TextureSampler {
 public:
  Color color(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return {0.5f, 0.5f, 0.5f}; }
  float value(std::uint32_t, Vec2f uv, Vec2f, Vec2f) const override { return 3 * uv.x - uv.y; }
  Vec3f normal(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return {0.9f, 0.4f, 0.8f}; }
};

/// The square of side 2 that faces +z, u along x and v along y, or turned about y so that its back is seen.
Scene square(IntegratorKind kind, const Material& material, bool turned) {
  Scene scene = bare_scene(3);
  scene.integrator.kind = kind;
  scene.textures.resize(1);
  scene.textures[0].path = "slope";
  const auto mesh = turned ? parallelogram({1, -1, 0}, {-2, 0, 0}, {0, 2, 0})
                           : parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  add_object(scene, MeshShape{mesh, {}}, add_material(scene, material));
  scene.camera.fov = 10;
  return scene;
}

Vec3f plane3(const Picture& p, const std::string& name) {
  return {value(p, (name + ".X").c_str(), 1, 1), value(p, (name + ".Y").c_str(), 1, 1),
          value(p, (name + ".Z").c_str(), 1, 1)};
}

TEST(NormalPass, ShowsNormalAndBumpMapsAndTheTrueNormalBesideThem) {
  Material plain = diffuse({1, 1, 1}), mapped = plain, bumped = plain;
  mapped.normal_texture = 0, bumped.bump_texture = 0, bumped.bump_scale = 0.5f;
  const SlopeTextures textures;
  struct Case {
    Material material;
    Vec3f want;  ///< in the frame of the square
  };
  // The square is two units wide, so its heights are half as steep.
  const Case cases[] = {{plain, {0, 0, 1}},
                        {mapped, normalize(Vec3f{0.8f, -0.2f, 0.6f})},
                        {bumped, normalize(Vec3f{-0.75f, 0.25f, 1})}};
  for (const Case& c : cases)
    for (const bool turned : {false, true})
      for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path, IntegratorKind::normal,
                                        IntegratorKind::facing, IntegratorKind::albedo}) {
        const Picture p =
            run(square(kind, c.material, turned), [&](RenderOptions& o) { o.textures = &textures; }).picture;
        // A turned square is seen from behind; its own normals point away.
        const Vec3f want = turned ? Vec3f{-c.want.x, c.want.y, -c.want.z} : c.want;
        EXPECT_NEAR(length(plane3(p, "N") - want), 0, 1e-5) << static_cast<int>(kind) << turned;
        EXPECT_NEAR(length(plane3(p, "Ng") - Vec3f{0, 0, turned ? -1.0f : 1.0f}), 0, 1e-6);
        if (kind == IntegratorKind::normal) {
          EXPECT_NEAR(length(color(p, 1, 1) - (want * 0.5f + Vec3f{0.5f, 0.5f, 0.5f})), 0, 1e-5);
        }
      }
}

// Smooth normals count, too.
TEST(NormalPass, SmoothNormalsDifferFromTrueOnes) {
  Scene scene = bare_scene(1);
  scene.camera.fov = 1;
  scene.camera.from = {0.05, 0.13, 5}, scene.camera.at = {0.05, 0.13, 0};
  add_object(scene, MeshShape{sphere_mesh(6), {}}, add_material(scene, diffuse({1, 1, 1})));
  const Picture p = run(scene).picture;
  const auto at = [&](const std::string& name) {
    return Vec3f{value(p, (name + ".X").c_str(), 0, 0), value(p, (name + ".Y").c_str(), 0, 0),
                 value(p, (name + ".Z").c_str(), 0, 0)};
  };
  EXPECT_GT(length(at("N") - at("Ng")), 0.05f);
  EXPECT_LT(length(at("N") - normalize(position(p, 0, 0))), 0.02f);
}

// ---- Images that are read.

TEST(AskedTextures, AreThoseThatThePictureShows) {
  Scene scene;
  scene.textures.resize(6);
  for (Texture& texture : scene.textures)
    texture.path = "a", texture.content = std::make_shared<std::string>("b");
  Material m;
  m.color_texture = 0, m.opacity_texture = 1, m.bump_texture = 2, m.normal_texture = 3,
  m.emission_texture = 4;
  scene.materials = {m};
  const auto asked = [&](IntegratorKind kind, bool data_layers) {
    scene.integrator.kind = kind;
    std::string numbers;
    const std::vector<Texture> textures = asked_textures(scene, data_layers);
    EXPECT_EQ(textures.size(), scene.textures.size());
    for (std::size_t i = 0; i < textures.size(); ++i) {
      EXPECT_EQ(textures[i].path.empty(), textures[i].content == nullptr);
      if (!textures[i].path.empty()) numbers += static_cast<char>('0' + i);
    }
    return numbers;
  };
  EXPECT_EQ(asked(IntegratorKind::whitted, false), "012345");
  EXPECT_EQ(asked(IntegratorKind::path, false), "012345");
  EXPECT_EQ(asked(IntegratorKind::facing, false), "1");
  EXPECT_EQ(asked(IntegratorKind::wire, false), "1");
  EXPECT_EQ(asked(IntegratorKind::albedo, false), "01");
  EXPECT_EQ(asked(IntegratorKind::normal, false), "123");
  EXPECT_EQ(asked(IntegratorKind::ao, false), "123");
  EXPECT_EQ(asked(IntegratorKind::facing, true), "0123");
}

}  // namespace
}  // namespace oktett::normal_pass_test
