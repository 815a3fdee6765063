/// \file Facets that are wider along one direction (KHR_materials_anisotropy).

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "render/bsdf/bsdf.h"
#include "render/bsdf/optics.h"
#include "tests/render/bsdf_support.h"
#include "tests/render/test_scenes.h"

namespace oktett::bsdf_anisotropy_test {
namespace {

/// Widths along x and y as the extension says.
struct Widths {
  double x, y;
};
Widths widths(const PrincipledParameters& p) {
  const double alpha = double{p.roughness} * double{p.roughness}, s = double{p.anisotropy};
  return {alpha + (1 - alpha) * s * s, alpha};
}

/// GGX of Heitz 2014 in terms of angles, unlike the code.
double stretched_density(const Vec3d& m, const Widths& a) {
  const double cos2 = m.z * m.z, tan2 = 1 / cos2 - 1, phi = std::atan2(m.y, m.x);
  const double along = std::pow(std::cos(phi) / a.x, 2) + std::pow(std::sin(phi) / a.y, 2);
  return 1 / (std::numbers::pi * a.x * a.y * cos2 * cos2 * std::pow(1 + tan2 * along, 2));
}
double stretched_lambda(const Vec3d& w, const Widths& a) {
  const double phi = std::atan2(w.y, w.x);
  return lambda(w.z, std::hypot(a.x * std::cos(phi), a.y * std::sin(phi)));
}

Vec3f random_above(std::uint64_t key) {
  return direction_at(0.05 + 0.95 * random_float(key, 1, 0), 2 * std::numbers::pi * random_float(key, 1, 1));
}

TEST(BsdfAnisotropy, BlackDielectricIsTheMicrofacetFormula) {
  for (std::uint64_t n = 0; n < 300; ++n) {
    const std::uint64_t key = mix_bits(n);
    const Vec3f wo = random_above(key), wi = random_above(key + 1);
    PrincipledParameters p;
    p.base_color = {0, 0, 0};
    p.roughness = 0.2f + 0.8f * random_float(key, 2, 0), p.anisotropy = random_float(key, 2, 1);
    const Widths a = widths(p);
    const Vec3d o(wo), i(wi), h = normalize(o + i);
    const double expected = fresnel(dot(o, h), 1.5) * stretched_density(h, a) /
                            (1 + stretched_lambda(o, a) + stretched_lambda(i, a)) / (4 * o.z);
    EXPECT_NEAR(principled_bsdf(p, wo, true).evaluate(wi).value.x, expected, 1e-3 * expected) << n;
  }
}

/// The angle of the half vector at which a highlight seen head-on is half as bright, along an azimuth.
double half_width(const PrincipledParameters& p, double phi) {
  const Bsdf bsdf = principled_bsdf(p, {0, 0, 1}, true);
  const auto value = [&](double angle) {
    return double{bsdf.evaluate(direction_at(std::cos(2 * angle), phi)).value.x};
  };
  const double top = value(0);
  double low = 0, high = 0.7;
  for (int i = 0; i < 50; ++i) (value((low + high) / 2) > top / 2 ? low : high) = (low + high) / 2;
  return low;
}

TEST(BsdfAnisotropy, HighlightsAreAsWideAsTheFacets) {
  for (const float anisotropy : {0.1f, 0.2f, 0.3f}) {
    PrincipledParameters p;
    p.base_color = {0, 0, 0}, p.roughness = 0.14f, p.anisotropy = anisotropy;
    const Widths a = widths(p);
    EXPECT_NEAR(half_width(p, 0) / half_width(p, std::numbers::pi / 2), a.x / a.y, 0.02 * a.x / a.y);
  }
}

TEST(BsdfAnisotropy, WhatLiesBelowTheInterfaceIsReciprocal) {
  for (std::uint64_t n = 0; n < 100; ++n) {
    const std::uint64_t key = mix_bits(n + 900);
    const Vec3f a = random_above(key), b = random_above(key + 1);
    PrincipledParameters p;
    p.roughness = 0.1f + 0.9f * random_float(key, 2, 0), p.anisotropy = random_float(key, 2, 1);
    const float there = principled_bsdf(p, a, true).evaluate(b).value.x / b.z;
    const float back = principled_bsdf(p, b, true).evaluate(a).value.x / a.z;
    EXPECT_NEAR(there, back, 2e-3 * double{back} + 1e-6);
  }
}

/// The light of samples of white surfaces: never more than arrives, and not much less.
TEST(BsdfAnisotropy, WhiteSurfacesStayWhite) {
  for (const int kind : {0, 1, 2, 3})
    for (const float roughness : {0.0f, 0.3f, 0.7f})
      for (const float anisotropy : {0.3f, 1.0f})
        for (const double mu : {0.1, 0.5, 1.0})
          for (const double phi : {0.0, 1.5707}) {
            PrincipledParameters p;
            p.base_color = {1, 1, 1}, p.roughness = roughness, p.anisotropy = anisotropy;
            p.metallic = kind == 0 ? 1 : 0, p.transmission = kind > 1 ? 1 : 0, p.thin = kind == 3;
            const Bsdf bsdf = principled_bsdf(p, direction_at(mu, phi), true);
            constexpr int kSide = 32;
            double sum = 0;
            for (int i = 0; i < kSide * kSide; ++i) {
              const auto s = bsdf.sample((i * 631 % (kSide * kSide) + 0.5f) / (kSide * kSide),
                                         {(i % kSide + 0.5) / kSide, (i / kSide + 0.5) / kSide});
              if (s) sum += double{s->weight.x} / (kSide * kSide);
            }
            EXPECT_LT(sum, 1.015) << kind << ' ' << roughness << ' ' << anisotropy << ' ' << mu << ' ' << phi;
            EXPECT_GT(sum, 0.95) << kind << ' ' << roughness << ' ' << anisotropy << ' ' << mu << ' ' << phi;
          }
}

// --- Directions on surfaces

/// A texture of one direction.
class OneDirection final : public TextureSampler {
 public:
  explicit OneDirection(const Vec3f& texel) : texel_(texel) {}
  Color color(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return {1, 1, 1}; }
  float value(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return 1; }
  Vec3f normal(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return texel_; }

 private:
  Vec3f texel_;
};

/// What a square in z = 0 shows, seen head-on, in light from the direction `to_light`; `by_u` and `by_v` are
/// the coordinates of its corners in the image.
float lit_square(const PrincipledMaterial& principled, const Vec3d& to_light, const Vec2f (&uvs)[4],
                 const TextureSampler* sampler = nullptr) {
  Scene scene = test::bare_scene(1);
  scene.integrator.kind = IntegratorKind::path, scene.integrator.depth = 1;
  scene.camera.from = {0, 0, 6}, scene.camera.projection = Projection::orthographic;
  scene.lights.push_back(DirectionalLight{-to_light, {1, 1, 1}});
  scene.textures.push_back({});
  auto mesh = std::make_shared<TriangleMesh>();
  for (const Vec3f& p : {Vec3f{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}) mesh->positions.push_back(p);
  for (const Vec2f& uv : uvs) mesh->uvs.push_back(uv);
  for (const std::uint32_t k : {0, 1, 2, 0, 2, 3}) mesh->indices.push_back(k), mesh->uv_indices.push_back(k);
  Material m;
  m.color = principled.parameters.base_color;
  m.principled = principled;
  test::add_object(scene, MeshShape{mesh, {}, false, TriangleTest::watertight}, test::add_material(scene, m));
  return test::value(test::run(scene, [&](RenderOptions& o) { o.textures = sampler; }).picture, "R", 0, 0);
}

TEST(BsdfAnisotropy, FacetsAreWiderAlongUOrWhereRotationAndImagePoint) {
  constexpr Vec2f kUpright[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  constexpr Vec2f kTurned[4] = {{0, 1}, {0, 0}, {1, 0}, {1, 1}};  // u runs along y, v along -x
  PrincipledMaterial material;
  PrincipledParameters& p = material.parameters;
  p.metallic = 1, p.base_color = {0.5f, 0.5f, 0.5f}, p.roughness = 0.3f, p.anisotropy = 0.6f;
  const auto expected = [&](const Vec3d& to_light) {
    return principled_bsdf(p, {0, 0, 1}, true).evaluate(Vec3f(to_light)).value.x *
           static_cast<float>(std::numbers::pi);
  };
  const Vec3d light = normalize(Vec3d{0.5, 0.2, 1}), turned{light.y, -light.x, light.z};
  // The two directions of light differ well.
  ASSERT_GT(std::abs(expected(light) / expected(turned) - 1), 0.3f);
  EXPECT_NEAR(lit_square(material, light, kUpright), expected(light), 1e-3f * expected(light));
  EXPECT_NEAR(lit_square(material, light, kTurned), expected(turned), 1e-3f * expected(turned));
  // A quarter turn from u towards v leads along y, as does an image that points along v.
  PrincipledMaterial rotated = material, shown = material;
  rotated.anisotropy_rotation = 90, shown.anisotropy_direction_texture = 0;
  const OneDirection along_v({0.5f, 1, 1});
  EXPECT_NEAR(lit_square(rotated, light, kUpright), expected(turned), 1e-3f * expected(turned));
  EXPECT_NEAR(lit_square(shown, light, kUpright, &along_v), expected(turned), 1e-3f * expected(turned));
}

}  // namespace
}  // namespace oktett::bsdf_anisotropy_test
