#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <mutex>

#include "tests/render/test_scenes.h"

namespace oktett::texture_test {
namespace {

using namespace test;

/// Textures given by functions of uv: 0 = stripes of colour by u, 1 = opaque for u > 0.5, 2 = a slope of
/// height along u, 3 = a normal leaning towards +u.
class FunctionTextures : public TextureSampler {
 public:
  Color color(std::uint32_t index, Vec2f uv, Vec2f dx, Vec2f dy) const override {
    const std::lock_guard lock(mutex_);
    last_dx = dx, last_dy = dy;
    return index == 0 ? Color{uv.x, uv.y, 0.5f} : Color{1, 1, 1};
  }
  float value(std::uint32_t index, Vec2f uv, Vec2f, Vec2f) const override {
    return index == 1 ? (uv.x > 0.5f ? 1.0f : 0.0f) : uv.x;
  }
  Vec3f normal(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return {0.5f + 0.3f, 0.5f, 0.5f + 0.4f}; }

  mutable Vec2f last_dx, last_dy;

 private:
  mutable std::mutex mutex_;
};

/// A square from -1 to 1 in the plane z = 0 with uv from 0 to 1, facing the camera.
Scene textured_square(const Material& material, std::uint32_t size = 16) {
  Scene scene = bare_scene(size);
  scene.camera.projection = Projection::orthographic;
  scene.camera.height = 2;
  auto mesh = std::make_shared<TriangleMesh>();
  for (int k = 0; k < 4; ++k) {
    const float u = k & 1 ? 1 : 0, v = k & 2 ? 1 : 0;
    mesh->positions.push_back({2 * u - 1, 2 * v - 1, 0});
    mesh->uvs.push_back({u, v});
  }
  for (const std::uint32_t i : {0u, 1u, 3u, 0u, 3u, 2u})
    mesh->indices.push_back(i), mesh->uv_indices.push_back(i);
  add_object(scene, MeshShape{mesh, {}, true, TriangleTest::watertight}, add_material(scene, material));
  return scene;
}

Picture run_textured(const Scene& scene, const FunctionTextures& textures) {
  return run(scene, [&](RenderOptions& o) { o.textures = &textures; }).picture;
}

TEST(Texture, MultipliesTheColour) {
  Material m = diffuse({1, 1, 0.5f});
  m.color_texture = 0;
  Scene scene = textured_square(m);
  scene.lights = {DirectionalLight{{0, 0, -1}, {1, 1, 1}}};
  const FunctionTextures textures;
  const Picture p = run_textured(scene, textures);
  for (std::uint32_t y = 0; y < 16; ++y)
    for (std::uint32_t x = 0; x < 16; ++x) {
      const Color want{(static_cast<float>(x) + 0.5f) / 16, (15.5f - static_cast<float>(y)) / 16, 0.25f};
      EXPECT_NEAR(length(color(p, x, y) - want), 0, 1e-5f);
      EXPECT_NEAR(value(p, "u", x, y), want.x, 1e-6f);
      EXPECT_NEAR(value(p, "v", x, y), want.y, 1e-6f);
    }
  // Without a sampler textures are white.
  EXPECT_NEAR(length(color(run(scene).picture, 3, 3) - Color{1, 1, 0.5f}), 0, 1e-6f);
}

TEST(Texture, FootprintIsTheStepToTheNextPixel) {
  Material m = glowing({1, 1, 1});
  m.emission_texture = 0;
  const FunctionTextures textures;
  run_textured(textured_square(m, 64), textures);
  EXPECT_NEAR(textures.last_dx.x, 1 / 64.0f, 1e-5f);
  EXPECT_NEAR(textures.last_dx.y, 0, 1e-5f);
  EXPECT_NEAR(textures.last_dy.x, 0, 1e-5f);
  EXPECT_NEAR(textures.last_dy.y, -1 / 64.0f, 1e-5f);
}

TEST(Texture, HolesShowAndLightWhatIsBehind) {
  Material m = glowing({1, 0, 0});
  m.opacity_texture = 1;
  Scene scene = textured_square(m);
  const FunctionTextures textures;
  Picture p = run_textured(scene, textures);
  EXPECT_EQ(color(p, 4, 8), (Color{0, 0, 0}));
  EXPECT_EQ(value(p, "A", 4, 8), 0);
  EXPECT_EQ(id(p, "geomID.I", 4, 8), kNoId);
  EXPECT_EQ(color(p, 12, 8), (Color{1, 0, 0}));
  EXPECT_EQ(value(p, "A", 12, 8), 1);
  // Seen through the hole: a floor that is lit through it, and in shadow behind the opaque half. Bounces are
  // not used up.
  add_object(scene, PlaneShape{{0, 0, 1}, -1}, add_material(scene, diffuse({1, 1, 1})));
  scene.integrator.depth = 0;
  scene.lights = {DirectionalLight{{0, 0, -1}, {1, 1, 1}}};
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path}) {
    scene.integrator.kind = kind;
    p = run_textured(scene, textures);
    EXPECT_EQ(color(p, 4, 8), (Color{1, 1, 1}));
    EXPECT_EQ(value(p, "A", 4, 8), 1);
    EXPECT_EQ(id(p, "geomID.I", 4, 8), 1u);
  }
  scene.lights = {DirectionalLight{{-1, 0, -1}, {1, 1, 1}}};
  EXPECT_EQ(color(run_textured(scene, textures), 6, 8), (Color{0, 0, 0}));
}

// The height rises along u by bump_scale per uv unit, that is by half of it per length: the normal leans to
// -u.
TEST(Texture, BumpsBendTheNormal) {
  Material m = diffuse({1, 1, 1});
  m.bump_texture = 2;
  m.bump_scale = 2;
  Scene scene = textured_square(m);
  scene.lights = {DirectionalLight{{1, 0, -1}, {1, 1, 1}}};
  const FunctionTextures textures;
  EXPECT_NEAR(color(run_textured(scene, textures), 8, 4).x, 1, 1e-3f);
  scene.lights = {DirectionalLight{{0, 0, -1}, {1, 1, 1}}};
  EXPECT_NEAR(color(run_textured(scene, textures), 8, 4).x, std::sqrt(0.5f), 1e-3f);
}

TEST(Texture, NormalMapsReplaceTheNormal) {
  Material m = diffuse({1, 1, 1});
  m.normal_texture = 3;
  Scene scene = textured_square(m);
  scene.lights = {DirectionalLight{{-0.6, 0, -0.8}, {1, 1, 1}}};
  const FunctionTextures textures;
  EXPECT_NEAR(color(run_textured(scene, textures), 8, 4).x, 1, 1e-5f);
}

/// The light that a normal map sends back from a lamp far away in this direction.
float lit(const Scene& square, const Vec3d& to_light) {
  Scene scene = square;
  scene.lights = {DirectionalLight{-to_light, {1, 1, 1}}};
  const FunctionTextures textures;
  return color(run_textured(scene, textures), 8, 4).x;
}

TriangleMesh& mesh_of(Scene& scene) {
  auto& shape = std::get<MeshShape>(scene.objects[0].shape);
  auto mesh = std::make_shared<TriangleMesh>(*shape.mesh);
  TriangleMesh& own = *mesh;
  shape.mesh = std::move(mesh);
  return own;
}

// The tilt is multiplied, the normal made to have length 1.
TEST(Texture, NormalMapsHaveAScale) {
  Material m = diffuse({1, 1, 1});
  m.normal_texture = 3;
  for (const float scale : {0.0f, 0.5f, 2.0f, -1.0f}) {
    m.normal_scale = scale;
    const Vec3d expected = normalize(Vec3d{0.6 * double{scale}, 0, 0.8});
    EXPECT_NEAR(lit(textured_square(m), expected), 1, 1e-5f) << scale;
  }
}

// The map leans to its first axis: the tangent, or where that is missing +u.
TEST(Texture, NormalMapsFollowTheTangentsOfAMesh) {
  Material m = diffuse({1, 1, 1});
  m.normal_texture = 3;
  const auto square_with = [&](const std::array<float, 4>& tangent) {
    Scene scene = textured_square(m);
    TriangleMesh& mesh = mesh_of(scene);
    for (int k = 0; k < 4; ++k) mesh.normals.push_back({0, 0, 1}), mesh.tangents.push_back(tangent);
    mesh.normal_indices = mesh.indices;
    return scene;
  };
  EXPECT_NEAR(lit(square_with({0, 1, 0, 1}), {0, 0.6, 0.8}), 1, 1e-5f);
  EXPECT_NEAR(lit(square_with({-2, 0, 0, 1}), {-0.6, 0, 0.8}), 1, 1e-5f);
  EXPECT_NEAR(lit(square_with({0, 0, 0, 0}), {0.6, 0, 0.8}), 1, 1e-5f);
  // The object turned by a quarter and mirrored.
  Scene turned = square_with({0, 1, 0, 1});
  turned.objects[0].transform.m = {{{0, -1, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 0}}};
  EXPECT_NEAR(lit(turned, {-0.6, 0, 0.8}), 1, 1e-5f);
}

/// As FunctionTextures, with a normal that leans towards the second axis of the map.
class LeaningUp : public FunctionTextures {
 public:
  Vec3f normal(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return {0.5f, 0.8f, 0.9f}; }
};

// The second axis is cross(n, tangent) times the sign; mirrors keep what the picture of the object shows.
TEST(Texture, TangentsHaveASide) {
  Material m = diffuse({1, 1, 1});
  m.normal_texture = 3;
  for (const float side : {1.0f, -1.0f})
    for (const double mirror : {1.0, -1.0}) {
      Scene scene = textured_square(m);
      TriangleMesh& mesh = mesh_of(scene);
      for (int k = 0; k < 4; ++k) mesh.normals.push_back({0, 0, 1}), mesh.tangents.push_back({1, 0, 0, side});
      mesh.normal_indices = mesh.indices;
      scene.objects[0].transform = Affine::scaling({1, mirror, 1});
      scene.lights = {DirectionalLight{{0, -0.6 * double{side} * mirror, -0.8}, {1, 1, 1}}};
      const LeaningUp textures;
      EXPECT_NEAR(color(run_textured(scene, textures), 8, 4).x, 1, 1e-5f) << side << " " << mirror;
    }
}

// An image turned by an angle counter-clockwise on uv has its first axis turned the other way on the surface.
TEST(Texture, NormalMapsTurnWithTheirImage) {
  Material m = diffuse({1, 1, 1});
  m.normal_texture = 3;
  for (const double angle : {0.0, 0.5, 2.0, -1.0}) {
    Scene scene = textured_square(m);
    scene.textures.resize(4);
    scene.textures[3].rotation = static_cast<float>(angle);
    EXPECT_NEAR(lit(scene, {0.6 * std::cos(angle), -0.6 * std::sin(angle), 0.8}), 1, 1e-5f) << angle;
  }
  Scene mirrored = textured_square(m);
  mirrored.textures.resize(4);
  mirrored.textures[3].scale = {-1, 1, 1};
  EXPECT_NEAR(lit(mirrored, {-0.6, 0, 0.8}), 1, 1e-5f);
}

// A texture of the second layer is looked up by the mesh's second coordinates, with their footprint.
TEST(Texture, TexturesMayLieBySecondCoordinates) {
  Material m = diffuse({1, 1, 1});
  m.color_texture = 0;
  Scene scene = textured_square(m);
  scene.textures.resize(1);
  scene.integrator.kind = IntegratorKind::albedo;
  TriangleMesh& mesh = mesh_of(scene);
  for (const Vec2f& uv : mesh.uvs) mesh.second_uvs.push_back({uv.y, 0.5f * uv.x});
  const FunctionTextures textures;
  const Color first = color(run_textured(scene, textures), 4, 9);
  EXPECT_NEAR(textures.last_dx.x, 1.0f / 16, 1e-5f);
  scene.textures[0].uv_layer = 1;
  const Color second = color(run_textured(scene, textures), 4, 9);
  EXPECT_NEAR(second.x, first.y, 1e-3f);
  EXPECT_NEAR(second.y, 0.5f * first.x, 1e-3f);
  EXPECT_NEAR(textures.last_dx.y, 0.5f / 16, 1e-5f);
  EXPECT_NEAR(textures.last_dx.x, 0, 1e-5f);
}

// Without data layers, lights reach textured hits in lanes, beside hits without textures. Pictures with data
// layers are shaded hit by hit and must be the same, holes and samples that are not finite included.
TEST(Texture, TexturedSurfacesLookTheSameInLanes) {
  Material m = diffuse({1, 0.9f, 0.5f});
  m.specular = 0.5f, m.phong = 12.5f, m.ambient = 0.2f, m.reflection = 0.25f;
  m.emission = {0.1f, 0.2f, 0.3f};
  m.color_texture = m.specular_texture = m.emission_texture = 0;
  m.opacity_texture = 1, m.bump_texture = 2, m.normal_texture = 3;
  Scene scene = textured_square(m, 45);
  scene.ambient_light = {1, 1, 1}, scene.background = {0.2f, 0.3f, 0.4f};
  scene.integrator.depth = 3;
  Material shiny = diffuse({0.5f, 0.7f, 0.9f});
  shiny.specular = 0.3f, shiny.phong = 40;
  add_object(scene, SphereShape{{0.3, 0.2, -1}, 0.8}, add_material(scene, shiny));
  shiny.phong = 0, shiny.ambient = 1;
  add_object(scene, SphereShape{{-0.6, 0.4, 0.5}, 0.3}, add_material(scene, shiny));
  Material endless = glowing({std::numeric_limits<float>::infinity(), 0, 0});
  add_object(scene, SphereShape{{0.1, -0.6, 0.5}, 0.2}, add_material(scene, endless));
  scene.lights = {DirectionalLight{{-0.6, 0.1, -0.8}, {1, 0.5f, 1}}, PointLight{{1, 2, 3}, {9, 9, 9}, true},
                  PointLight{{-1, 2, 3}, {1, 1, 1}, false}};
  const FunctionTextures textures;
  for (const std::uint32_t samples : {1u, 4u}) {
    scene.integrator.samples = samples;
    const RenderResult with = run(scene, [&](RenderOptions& o) { o.textures = &textures; });
    EXPECT_GT(with.report.bad_samples, 0u);
    for (const Isa isa : available_isas())
      for (const std::uint32_t tile : {1u, 7u, 32u, 100u}) {
        const RenderResult without = run(scene, [&](RenderOptions& o) {
          o.textures = &textures, o.data_layers = false, o.isa = isa, o.tile_size = tile;
        });
        EXPECT_EQ(without.report.bad_samples, with.report.bad_samples);
        EXPECT_EQ(without.report.shadow_rays, with.report.shadow_rays);
        for (std::size_t k = 0; k < 4; ++k)
          for (std::size_t i = 0; i < with.picture.planes[k].values.size(); ++i)
            ASSERT_EQ(std::bit_cast<std::uint32_t>(with.picture.planes[k].values[i]),
                      std::bit_cast<std::uint32_t>(without.picture.planes[k].values[i]))
                << to_string(isa) << ", tile " << tile << ", plane " << k << ", pixel " << i;
      }
  }
}

/// Columns of values that no parameter can have, and those at the ends of ranges.
class ExtremeTextures : public TextureSampler {
 public:
  Color color(std::uint32_t, Vec2f uv, Vec2f, Vec2f) const override {
    return {texel(uv), texel(uv, 0.7f), texel(uv, 0.3f)};
  }
  float value(std::uint32_t, Vec2f uv, Vec2f, Vec2f) const override { return texel(uv); }
  Vec3f normal(std::uint32_t, Vec2f uv, Vec2f, Vec2f) const override {
    return {texel(uv), texel(uv, 0.6f), texel(uv, 0.8f)};
  }

 private:
  static float texel(Vec2f uv, float scale = 1) {
    constexpr float kHuge = std::numeric_limits<float>::max(),
                    kInfinity = std::numeric_limits<float>::infinity();
    constexpr float kTexels[] = {
        0, std::numeric_limits<float>::quiet_NaN(), 0.5f, kInfinity, -kInfinity, -1, 1, 1e-30f, -kHuge};
    return kTexels[static_cast<std::size_t>(scale * (std::abs(uv.x) * 16 + std::abs(uv.y) * 5)) %
                   std::size(kTexels)];
  }
};

void expect_finite(const Scene& scene) {
  const ExtremeTextures textures;
  const RenderResult result = run(scene, [&](RenderOptions& o) { o.textures = &textures; });
  EXPECT_EQ(result.report.bad_samples, 0u);
  for (const char* plane : {"R", "G", "B", "A"})
    for (const float v : result.picture.find(plane)->values)
      ASSERT_TRUE(std::isfinite(v) && v >= 0) << plane << ' ' << v;
}

Scene lit_square(const Material& material) {
  Scene scene = textured_square(material, 32);
  scene.background = {1, 1, 1};
  scene.lights = {DirectionalLight{{-0.6, 0.1, -0.8}, {1, 0.5f, 1}}, PointLight{{1, 2, 3}, {9, 9, 9}, true}};
  scene.integrator.samples = 16, scene.integrator.depth = 4;
  add_object(scene, SphereShape{{0, 0, -1}, 0.8}, add_material(scene, mirror()));
  return scene;
}

// Texels that are NaN, infinite or out of range, for one parameter at a time and for all together.
TEST(Texture, ExtremeTexelsOfPrincipledParametersGiveFinitePictures) {
  for (const float transmission : {0.0f, 0.5f, 1.0f}) {
    Material plain = diffuse({1, 1, 1});
    plain.principled.emplace();
    PrincipledParameters& p = plain.principled->parameters;
    p.transmission = transmission, p.roughness = 0.4f, p.metallic = 0.25f, p.coat = 0.5f, p.sheen = 0.5f;
    const auto render_with = [](const Material& m) {
      Scene scene = lit_square(m);
      scene.integrator.kind = IntegratorKind::path;
      expect_finite(scene);
    };
    Material all = plain;
    all.color_texture = all.emission_texture = all.opacity_texture = all.bump_texture = 0;
    all.principled->sheen_color_texture = 0;
    for (const PrincipledNumber& number : kPrincipledNumbers) {
      SCOPED_TRACE(number.name);
      Material one = plain;
      (*one.principled).*number.texture = (*all.principled).*number.texture = 0;
      render_with(one);
    }
    SCOPED_TRACE("all");
    render_with(all);
    all.bump_texture = kNoId, all.normal_texture = 0;
    render_with(all);
  }
}

TEST(Texture, ExtremeTexelsOfPhongsParametersGiveFinitePictures) {
  Material plain = diffuse({0.5f, 0.5f, 0.5f});
  plain.specular = 0.3f, plain.phong = 20, plain.transparency = 0.25f, plain.reflection = 0.25f;
  plain.emission = {1, 1, 1};
  const auto render_with = [](const Material& m) {
    Scene scene = lit_square(m);
    scene.ambient_light = {1, 1, 1};
    for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::whitted}) {
      scene.integrator.kind = kind;
      expect_finite(scene);
    }
  };
  Material all = plain;
  for (const auto texture :
       {&Material::color_texture, &Material::specular_texture, &Material::emission_texture,
        &Material::opacity_texture, &Material::bump_texture, &Material::normal_texture}) {
    Material one = plain;
    one.*texture = all.*texture = 0;
    render_with(one);
  }
  for (const PhongNumber& number : kPhongNumbers) {
    SCOPED_TRACE(number.name);
    Material one = plain;
    one.*number.texture = all.*number.texture = 0;
    render_with(one);
  }
  SCOPED_TRACE("all");
  render_with(all);
}

}  // namespace
}  // namespace oktett::texture_test
