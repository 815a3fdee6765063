/// \file Normals of the coat that are not those of what lies below.

#include <gtest/gtest.h>

#include <cmath>

#include "render/bsdf/bsdf.h"
#include "render/bsdf/optics.h"
#include "tests/render/bsdf_support.h"
#include "tests/render/test_scenes.h"

namespace oktett::coat_normal_test {
namespace {

PrincipledParameters black_coat(float roughness, const Vec3f& normal = {0, 0, 1}) {
  PrincipledParameters p;
  p.base_color = {0, 0, 0}, p.specular = 0;
  p.coat = 1, p.coat_roughness = roughness, p.coat_normal = normal;
  return p;
}

TEST(CoatNormal, SmoothCoatsMirrorAboutIt) {
  for (const Vec3f& given : {Vec3f{0.2f, -0.1f, 1}, Vec3f{-0.4f, 0.3f, 0.9f}}) {
    const Vec3d n = normalize(Vec3d(given)), wo = Vec3d(direction_at(0.8, 0.7));
    const Bsdf bsdf = principled_bsdf(black_coat(0, given), Vec3f(wo), true);
    const auto sample = bsdf.sample(0.01f, {0.3, 0.6});
    ASSERT_TRUE(sample && sample->delta);
    const Vec3d mirrored = n * (2 * dot(wo, n)) - wo;
    ASSERT_GT(mirrored.z, 0);
    EXPECT_LT(length(Vec3d(sample->direction) - mirrored), 1e-6);
  }
  // A ray that would go below the surface is folded back.
  const Bsdf steep = principled_bsdf(black_coat(0, {0.8f, 0, 0.6f}), direction_at(0.9, 3), true);
  const auto folded = steep.sample(0.01f, {});
  ASSERT_TRUE(folded);
  EXPECT_GT(folded->direction.z, 0);
  EXPECT_FALSE(folded->transmitted);
}

// The same as an upright coat, seen from the frame about its own normal.
TEST(CoatNormal, RoughCoatsAreTurnedOnes) {
  int seen = 0;
  for (std::uint64_t n = 0; n < 400; ++n) {
    const std::uint64_t key = mix_bits(n);
    const Vec3f normal = direction_at(0.7 + 0.3 * random_float(key, 1, 0), 6.28 * random_float(key, 1, 1));
    Vec3d x, y;
    make_basis(normalize(Vec3d(normal)), x, y);
    const auto turned = [&](const Vec3f& w) {
      return Vec3f(Vec3d{dot(Vec3d(w), x), dot(Vec3d(w), y), dot(Vec3d(w), normalize(Vec3d(normal)))});
    };
    const Vec3f wo = direction_at(0.1 + 0.9 * random_float(key, 2, 0), 6.28 * random_float(key, 2, 1)),
                wi = direction_at(0.1 + 0.9 * random_float(key, 3, 0), 6.28 * random_float(key, 3, 1));
    if (turned(wo).z < 0.01f) continue;
    const float roughness = 0.15f + 0.8f * random_float(key, 4, 0);
    const BsdfValue tilted = principled_bsdf(black_coat(roughness, normal), wo, true).evaluate(wi);
    if (turned(wi).z <= 0) {
      EXPECT_LT(tilted.value.x, 1e-20f);
      continue;
    }
    const BsdfValue upright = principled_bsdf(black_coat(roughness), turned(wo), true).evaluate(turned(wi));
    EXPECT_NEAR(tilted.value.x, upright.value.x, 1e-4 * upright.value.x + 1e-7);
    ++seen;
  }
  EXPECT_GT(seen, 200);
}

TEST(CoatNormal, TiltedCoatsGainNoEnergy) {
  for (const Vec3f& normal : {Vec3f{0.1f, 0, 1}, Vec3f{-0.3f, 0.4f, 1}, Vec3f{2, 0, 1}})
    for (const float roughness : {0.0f, 0.2f, 0.5f, 1.0f})
      for (const double mu : {0.1, 0.4, 0.8, 1.0}) {
        PrincipledParameters p = black_coat(roughness, normal);
        p.base_color = {1, 1, 1};
        const Bsdf bsdf = principled_bsdf(p, direction_at(mu, 0.4), true);
        constexpr int kSide = 100;
        double sum = 0;
        for (int i = 0; i < kSide * kSide; ++i) {
          const auto s =
              bsdf.sample(random_float(5, i, 0), {(i % kSide + 0.5) / kSide, (i / kSide + 0.5) / kSide});
          if (s) sum += double{s->weight.x} / (kSide * kSide);
        }
        EXPECT_LT(sum, 1.01) << normal.x << ' ' << roughness << ' ' << mu;
        EXPECT_GT(sum, 0.3) << normal.x << ' ' << roughness << ' ' << mu;
      }
}

/// An image of one tangent-space normal.
class OneNormal final : public TextureSampler {
 public:
  Color color(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return {1, 1, 1}; }
  float value(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return 1; }
  Vec3f normal(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return {0.65f, 0.6f, 0.95f}; }
};

/// A ball with a coat, lit from the side of the viewer: the red of its pixels.
std::vector<float> ball(const std::function<void(Material&, PrincipledMaterial&)>& change) {
  Scene scene = test::bare_scene(32);
  scene.integrator.kind = IntegratorKind::path, scene.integrator.depth = 1;
  scene.camera.from = {0, 0, 6};
  scene.lights.push_back(DirectionalLight{{0.1, -0.3, -1}, {1, 1, 1}});
  scene.textures.push_back({});
  Material m;
  m.color = {0, 0, 0};
  m.principled.emplace().parameters = black_coat(0.6f);
  change(m, *m.principled);
  test::add_object(scene, SphereShape{}, test::add_material(scene, m));
  const OneNormal texture;
  const RenderResult result = test::run(scene, [&](RenderOptions& o) { o.textures = &texture; });
  const auto& red = result.picture.find("R")->values;
  return {red.begin(), red.end()};
}

/// The greatest difference where there is light, away from the rim.
void expect_same(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  int compared = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      if (std::hypot(x - 15.5, y - 15.5) > 4) continue;
      const auto i = static_cast<std::size_t>(32 * y + x);
      EXPECT_NEAR(a[i], b[i], 2e-3 * double{b[i]}) << x << ' ' << y;
      compared += b[i] > 0;
    }
  EXPECT_GT(compared, 40);
}

TEST(CoatNormal, ImagesBendTheCoatAloneOrWhatLiesBelow) {
  const auto plain = ball([](Material&, PrincipledMaterial&) {});
  const auto both = ball([](Material& m, PrincipledMaterial&) { m.normal_texture = 0; });
  const auto coat = ball([](Material&, PrincipledMaterial& p) { p.coat_normal_texture = 0; });
  const auto below =
      ball([](Material& m, PrincipledMaterial& p) { m.normal_texture = 0, p.even_coat = true; });
  const auto flat =
      ball([](Material&, PrincipledMaterial& p) { p.coat_normal_texture = 0, p.coat_normal_scale = 0; });
  EXPECT_GT(std::abs(both[32 * 16 + 16] - plain[32 * 16 + 16]), 0.1f * plain[32 * 16 + 16]);
  // What lies below is black, so the coat is all that is seen.
  expect_same(coat, both);
  expect_same(below, plain);
  expect_same(flat, plain);
}

}  // namespace
}  // namespace oktett::coat_normal_test
