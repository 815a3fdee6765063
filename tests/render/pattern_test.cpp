/// \file Patterns by closed forms, and textures of single numbers.

#include "render/pattern.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "core/random.h"
#include "render/bsdf/metals.h"
#include "render/shading_point.h"
#include "tests/render/light_checks.h"
#include "tests/render/test_scenes.h"

namespace oktett::pattern_test {
namespace {

using light_checks::Random;
using test::add_material;
using test::add_object;
using test::bare_scene;

Vec3d random_point(Random& random, double reach) {
  return {random.between(-reach, reach), random.between(-reach, reach), random.between(-reach, reach)};
}

TEST(Pattern, CheckersAreCubesInTurn) {
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    const double size = random.between(0.1, 3);
    const Vec3d p = random_point(random, 20);
    long long sum = 0;
    for (int k = 0; k < 3; ++k) sum += static_cast<long long>(std::floor(p[k] / size + 1 / 4096.0));
    EXPECT_EQ(pattern_value(CheckerPattern{size}, p), sum % 2 == 0 ? 0 : 1);
  }
  // The faces of a cube of that size show whole squares, whatever the rounding of their places.
  for (const double z : {1 - 1e-7, 1.0, 1 + 1e-7})
    EXPECT_EQ(pattern_value(CheckerPattern{1}, {0.5, 0.5, z}), 1);
}

TEST(Pattern, GradientsAreLinear) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d from = random_point(random, 3), to = random_point(random, 3);
    const double part = random.between(-0.5, 1.5);
    // Sideways nothing changes.
    const Vec3d aside = cross(to - from, random_point(random, 1));
    const double expected = std::min(1.0, std::max(0.0, part));
    EXPECT_NEAR(pattern_value(GradientPattern{from, to}, from + (to - from) * part + aside), expected, 1e-9);
    const RadialPattern radial{from, 0.5, 2};
    const double distance = std::hypot(to.x - from.x, to.y - from.y, to.z - from.z);
    EXPECT_NEAR(pattern_value(radial, to), std::min(1.0, std::max(0.0, (distance - 0.5) / 1.5)), 1e-12);
  }
}

TEST(Pattern, MarbleAndWoodWithoutDistortionAreLayersAndRings) {
  Random random(3);
  MarblePattern marble{0.7, 0};
  WoodPattern wood{0.3, 0};
  for (int i = 0; i < 1000; ++i) {
    const Vec3d p = random_point(random, 5);
    EXPECT_NEAR(pattern_value(marble, p), std::pow(std::sin(std::numbers::pi * p.x / 0.7), 2), 1e-9);
    const double ring = std::fmod(std::hypot(p.x, p.z) / 0.3, 1);
    EXPECT_NEAR(pattern_value(wood, p), ring * ring * (3 - 2 * ring), 1e-9);
  }
}

/// Gradient noise as a sum over the corners of a cell: each gradient's linear function times a window.
double noise_by_windows(const Vec3d& p) {
  const auto window = [](double d) {
    const double t = 1 - std::abs(d);
    return t <= 0 ? 0 : 10 * std::pow(t, 3) - 15 * std::pow(t, 4) + 6 * std::pow(t, 5);
  };
  double sum = 0;
  const long long cell[3] = {std::llround(std::floor(p.x)), std::llround(std::floor(p.y)),
                             std::llround(std::floor(p.z))};
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) {
        const long long corner[3] = {cell[0] + i, cell[1] + j, cell[2] + k};
        std::uint64_t bits = 0;
        for (const long long c : corner) bits = mix_bits(bits + static_cast<std::uint64_t>(c) + kGoldenBits);
        const double d[3] = {p.x - static_cast<double>(corner[0]), p.y - static_cast<double>(corner[1]),
                             p.z - static_cast<double>(corner[2])};
        const auto axis = static_cast<int>((bits >> 32) % 3);
        const double slope = (bits & 1 ? -1 : 1) * d[axis] + (bits & 2 ? -1 : 1) * d[(axis + 1) % 3];
        sum += slope * window(d[0]) * window(d[1]) * window(d[2]);
      }
  return sum;
}

TEST(Pattern, NoiseIsTheSumOfItsOctaves) {
  Random random(4);
  double mean = 0, least = 1, most = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3d p = random_point(random, 50);
    NoisePattern noise{0.8, {3, 0.6}};
    Vec3d q = p / 0.8;
    double sum = 0;
    for (const double weight : {1.0, 0.6, 0.36}) {
      sum += weight * noise_by_windows(q);
      q = q * 2 + Vec3d{0.5, 0.5, 0.5};
    }
    const double value = pattern_value(noise, p);
    EXPECT_NEAR(value, 0.5 + 0.5 * sum / 1.96, 1e-10);
    mean += value / 4000, least = std::min(least, value), most = std::max(most, value);
  }
  EXPECT_NEAR(mean, 0.5, 0.01);
  EXPECT_LT(least, 0.3);
  EXPECT_GT(most, 0.7);
}

TEST(Pattern, PointsWithoutAPlaceHaveTheFirstColour) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const Pattern& pattern :
       {Pattern(CheckerPattern{}), Pattern(GradientPattern{}), Pattern(RadialPattern{}),
        Pattern(NoisePattern{}), Pattern(MarblePattern{}), Pattern(WoodPattern{})})
    for (const Vec3d& p : {Vec3d{nan, 0, 0}, Vec3d{0, -inf, inf}, Vec3d{1e300, -1e300, 1e300}}) {
      const double value = pattern_value(pattern, p);
      EXPECT_TRUE(value >= 0 && value <= 1) << pattern.index();
    }
}

TEST(Pattern, ColoursStandInEqualSteps) {
  PatternTexture texture;
  texture.pattern = GradientPattern{{0, 0, 0}, {3, 0, 0}};
  texture.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 5, 5}};
  texture.to_pattern = Affine::translation({-1, 0, 0});
  const auto at = [&](double x) { return pattern_color(texture, {x + 1, 7, 7}); };
  EXPECT_EQ(at(-1), (Color{1, 0, 0}));
  EXPECT_EQ(at(1), (Color{0, 1, 0}));
  EXPECT_EQ(at(1.5), (Color{0, 0.5f, 0.5f}));
  EXPECT_EQ(at(9), (Color{5, 5, 5}));
  texture.colors = {{2, 3, 4}};
  EXPECT_EQ(at(1.5), (Color{2, 3, 4}));
}

TEST(Pattern, SlopesFollowTheChainRule) {
  Random random(5);
  PatternTexture texture;
  texture.pattern = GradientPattern{{0, 0, 0}, {0, 0, 4}};
  texture.colors = {{1, 0, 0}, {3, 0, 0}};
  texture.to_pattern = Affine::rotation({10, 20, 30}) * Affine::scaling({2, 1, 0.5});
  for (int i = 0; i < 100; ++i) {
    const Vec3d p = random_point(random, 0.5) + texture.to_pattern.inverse().point({0, 0, 2});
    const Vec3d slope = pattern_slope(texture, p);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(slope[k], 0.5 * texture.to_pattern.m[2][k], 1e-9);
  }
}

/// Answers everything with one number.
class Constant final : public TextureSampler {
 public:
  explicit Constant(float value) : value_(value) {}
  Color color(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return {value_, value_, value_}; }
  float value(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return value_; }

 private:
  float value_;
};

/// The picture of a ball before a white sky and a floor that is lit through it, whose material is changed by
/// `with`, with that sampler.
Picture ball_with(const TextureSampler& sampler, const std::function<void(Material&)>& with,
                  IntegratorKind kind = IntegratorKind::path) {
  Scene scene = bare_scene(8);
  scene.integrator.kind = kind;
  scene.background = {1, 1, 1};
  scene.textures.emplace_back();
  Material m = test::diffuse({0.5f, 0.4f, 0.3f});
  with(m);
  add_object(scene, SphereShape{{0, 0, 0}, 1.5}, add_material(scene, m));
  add_object(scene, PlaneShape{{0, 1, 0}, -1.5}, add_material(scene, test::diffuse({1, 1, 1})));
  scene.lights = {DirectionalLight{{0.2, -1, 0.5}, {1, 1, 1}}};
  RenderResult result = test::run(scene, [&](RenderOptions& options) { options.textures = &sampler; });
  EXPECT_EQ(result.report.bad_samples, 0u);
  return std::move(result.picture);
}

TEST(BadTexels, CountAsBlackOrAsTheLeastNumber) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, inf, -inf, -1.0f}) {
    const Constant sampler(bad);
    for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::whitted}) {
      const Picture black = ball_with(
          sampler, [](Material& m) { m.color_texture = 0; }, kind);
      EXPECT_EQ(test::value(black, "R", 4, 4), 0) << bad;
    }
    for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::whitted}) {
      for (const PhongNumber& number : kPhongNumbers)
        ball_with(
            sampler, [&](Material& m) { m.*number.texture = 0, m.*number.value = 1; }, kind);
      for (const PrincipledNumber& number : kPrincipledNumbers)
        ball_with(
            sampler,
            [&](Material& m) {
              m.principled.emplace();
              (*m.principled).*number.texture = 0, m.principled->parameters.*number.value = 1;
              resemble_principled(m);
            },
            kind);
      // NaN and negative opacities are holes, as 0 is.
      const Picture picture = ball_with(
          sampler, [](Material& m) { m.opacity_texture = 0; }, kind);
      const Picture expected = ball_with(
          sampler, [&](Material& m) { m.opacity = bad == inf ? 1 : 0; }, kind);
      EXPECT_TRUE(test::same_bytes(picture, expected)) << bad;
    }
  }
}

// A texture of constant value is the same as that value in the parameter, bit for bit.
TEST(TexturedNumbers, OfOneValueAreThatValue) {
  const Constant half(0.5f);
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::whitted}) {
    for (const PhongNumber& number : kPhongNumbers) {
      const auto all = [](Material& m) {
        m.diffuse = 0.4f, m.specular = 0.2f, m.phong = 8, m.reflection = 0.1f, m.transparency = 0.1f;
        m.ambient = 0.3f;
      };
      const Picture textured = ball_with(
          half, [&](Material& m) { all(m), m.*number.texture = 0; }, kind);
      const Picture plain = ball_with(
          half, [&](Material& m) { all(m), m.*number.value *= 0.5f; }, kind);
      EXPECT_TRUE(test::same_bytes(textured, plain)) << number.name;
    }
    for (const float metallic : {0.2f, 1.0f})
      for (const PrincipledNumber& number : kPrincipledNumbers) {
        const auto all = [&](Material& m) {
          PrincipledParameters& p = m.principled.emplace().parameters;
          p.base_color = m.color;
          p.metallic = metallic, p.roughness = 0.3f, p.transmission = 0.6f;
          p.coat = 0.4f, p.coat_roughness = 0.3f, p.sheen = 0.5f;
          p.ior = 2.5f, p.coat_ior = 2.2f;
        };
        const Picture textured = ball_with(
            half, [&](Material& m) { all(m), (*m.principled).*number.texture = 0, resemble_principled(m); },
            kind);
        const Picture plain = ball_with(
            half,
            [&](Material& m) {
              all(m), m.principled->parameters.*number.value *= 0.5f, resemble_principled(m);
            },
            kind);
        EXPECT_TRUE(test::same_bytes(textured, plain)) << number.name << " of metal " << metallic;
      }
  }
}

// The same for indices of refraction: that of Phong's model and the complex one of metals.
TEST(TexturedNumbers, IndicesOfRefraction) {
  const Constant half(0.5f);
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::whitted}) {
    const auto glass = [&](float ior, std::uint32_t texture) {
      return ball_with(
          half,
          [&](Material& m) { m.diffuse = 0.2f, m.transparency = 0.8f, m.ior = ior, m.ior_texture = texture; },
          kind);
    };
    EXPECT_TRUE(test::same_bytes(glass(3, 0), glass(1.5f, kNoId)));
    EXPECT_FALSE(test::same_bytes(glass(3, 0), glass(3, kNoId)));
    const auto metal = [&](float times, std::uint32_t texture) {
      return ball_with(
          half,
          [&](Material& m) {
            PrincipledMaterial& p = m.principled.emplace();
            Conductor& gold = p.parameters.conductor.emplace();
            gold.eta *= times, gold.k *= times;
            p.eta_texture = p.k_texture = texture;
            p.parameters.metallic = 1, p.parameters.roughness = 0.1f;
            if (texture == kNoId) m.color = p.parameters.base_color = head_on_color(gold);
            resemble_principled(m);
          },
          kind);
    };
    const Picture textured = metal(2, 0), plain = metal(1, kNoId), other = metal(2, kNoId);
    for (const char* plane : {"R", "G", "B"})
      for (std::uint32_t x = 0; x < 8; ++x)
        EXPECT_EQ(test::value(textured, plane, x, 4), test::value(plain, plane, x, 4)) << plane << x;
    EXPECT_NE(test::value(textured, "R", 4, 4), test::value(other, "R", 4, 4));
  }
}

// Of a surface of opacity a before a background of radiance 1, and without light of its own, 1 - a is seen.
TEST(Opacity, LetsTheRestPass) {
  const Constant white(1);
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::whitted}) {
    Scene scene = bare_scene(16);
    scene.integrator.kind = kind;
    scene.integrator.samples = 64;
    scene.background = {1, 1, 1};
    Material m = test::diffuse({0, 0, 0});
    m.opacity = 0.25f;
    add_object(scene, DiskShape{{0, 0, 0}, {0, 0, 1}, 50}, add_material(scene, m));
    const Picture picture = test::run(scene).picture;
    double mean = 0;
    for (const float v : picture.find("R")->values) mean += v / 256.0;
    EXPECT_NEAR(mean, 0.75, kind == IntegratorKind::path ? 0.01 : 1e-6);
  }
}

// Before a background that covers each pixel is covered wholly, however many holes its samples drew; before
// nothing a pixel is covered as often as a sample meets no hole.
TEST(Opacity, CoversWhatIsSeen) {
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::whitted})
    for (const bool priorities : {false, true}) {
      Scene scene = bare_scene(8);
      scene.integrator.kind = kind, scene.integrator.samples = 16;
      Material m = test::diffuse({1, 1, 1});
      m.opacity = 0.25f;
      add_object(scene, DiskShape{{0, 0, 0}, {0, 0, 1}, 50}, add_material(scene, m));
      // Solids of a priority are traced one by one.
      Material solid = test::glass(1.5f);
      if (priorities) solid.priority = 1;
      add_object(scene, SphereShape{{0, 0, 900}, 1}, add_material(scene, solid));
      const Picture before_nothing = test::run(scene).picture;
      double mean = 0;
      for (const float v : before_nothing.find("A")->values) mean += v / 64.0;
      EXPECT_NEAR(mean, 0.25, kind == IntegratorKind::path ? 0.05 : 1e-6) << priorities;
      scene.background = {1, 1, 1};
      const Picture before_light = test::run(scene).picture;
      for (const float v : before_light.find("A")->values) EXPECT_EQ(v, 1) << priorities;
    }
}

// However many holes a path or a shadow ray leads through, no light is lost.
TEST(Opacity, ManyHolesInARowLoseNothing) {
  for (const bool priorities : {false, true}) {
    Scene scene = bare_scene(2);
    scene.integrator.kind = IntegratorKind::path, scene.integrator.depth = 1;
    Material hole;
    hole.opacity = 0;
    const std::uint32_t holes = add_material(scene, hole);
    for (int i = 0; i < 150; ++i) add_object(scene, DiskShape{{0, 0, -1.0 * i}, {0, 0, 1}, 50}, holes);
    Material solid = test::glass(1.5f);
    if (priorities) solid.priority = 1;
    add_object(scene, SphereShape{{0, 0, 900}, 1}, add_material(scene, solid));
    add_object(scene, PlaneShape{{0, 0, 1}, -200}, add_material(scene, test::diffuse({1, 1, 1})));
    scene.lights = {DirectionalLight{{0, 0, -1}, {0.75f, 0.75f, 0.75f}}};
    const Picture picture = test::run(scene).picture;
    for (const float v : picture.find("R")->values)
      EXPECT_NEAR(static_cast<double>(v), 0.75, 1e-5) << priorities;
  }
}

TEST(PatternColor, LiesInTheObjectsSpace) {
  // What is seen through an instance inside an instance depends on the place before all transforms.
  Scene scene = bare_scene(32);
  PatternTexture pattern;
  pattern.pattern = GradientPattern{{0, -1, 0}, {0, 1, 0}};
  Texture texture;
  texture.pattern = pattern;
  scene.textures.push_back(texture);
  Material m = test::diffuse({1, 1, 1});
  m.color_texture = 0;
  const std::uint32_t material = add_material(scene, m);
  const Affine own = Affine::scaling({0.5, 2, 1}), inner = Affine::rotation({0, 0, 50}),
               outer = Affine::translation({0.2, 0, 0});
  scene.prototypes.resize(2);
  Object ball;
  ball.shape = SphereShape{};
  ball.material = material, ball.transform = own;
  scene.prototypes[0].objects.push_back(ball);
  Object instance;
  instance.shape = InstanceShape{0};
  instance.transform = inner;
  scene.prototypes[1].objects.push_back(instance);
  instance.shape = InstanceShape{1};
  instance.transform = outer;
  scene.objects.push_back(instance);
  scene.camera.from = {0, 0, 8};
  const Picture picture = test::run(scene).picture;
  const Affine back = (outer * inner * own).inverse();
  int compared = 0;
  for (std::size_t i = 0; i < 32 * 32; ++i) {
    if (!std::isfinite(picture.find("Z")->values[i])) continue;
    const Vec3d p{picture.find("P.X")->values[i], picture.find("P.Y")->values[i],
                  picture.find("P.Z")->values[i]};
    EXPECT_NEAR(picture.find("Albedo.R")->values[i], 0.5 + 0.5 * back.point(p).y, 1e-4);
    ++compared;
  }
  EXPECT_GT(compared, 50);
}

}  // namespace
}  // namespace oktett::pattern_test
