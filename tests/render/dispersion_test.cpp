/// \file Glass that bends red, green and blue differently.

#include "render/dispersion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/bsdf/optics.h"
#include "tests/render/photon_support.h"

namespace oktett::dispersion_test {
namespace {

/// Schott's glass N-BK7 by its catalogue's formula of Sellmeier, at a wavelength in micrometres.
double bk7(double wavelength) {
  const double square = wavelength * wavelength;
  return std::sqrt(1 + 1.03961212 * square / (square - 0.00600069867) +
                   0.231792344 * square / (square - 0.0200179144) +
                   1.01046945 * square / (square - 103.560653));
}

TEST(Dispersion, IndicesAreThoseOfMeasuredGlass) {
  const double d = bk7(0.58756), abbe = (d - 1) / (bk7(0.48613) - bk7(0.65627));
  EXPECT_NEAR(abbe, 64.17, 0.01);
  constexpr double kWavelengths[] = {0.63, 0.532, 0.467};
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(dispersed_ior(static_cast<float>(d), static_cast<float>(20 / abbe), k), bk7(kWavelengths[k]),
                4e-4);
}

TEST(Dispersion, IndicesStayOnTheirSideOfOne) {
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(dispersed_ior(1.5f, 0, k), 1.5f);
    EXPECT_EQ(dispersed_ior(1, 20, k), 1);
    EXPECT_GE(dispersed_ior(1.1f, 20, k), 1);
    EXPECT_LE(dispersed_ior(0.6f, 20, k), 1);
    EXPECT_LE(dispersed_ior(4, 20, k), 4);
  }
}

Material dispersive(float dispersion) {
  Material m;
  m.principled.emplace();
  PrincipledParameters& p = m.principled->parameters;
  m.color = p.base_color = {1, 1, 1};
  p.roughness = 0, p.transmission = 1, p.dispersion = dispersion;
  resemble_principled(m);
  return m;
}

// A floor below the surface of glass shines with as much light as its x. So each channel of the picture says
// where its light comes from, and how much of it passed the surface.
TEST(Dispersion, ColoursComeFromWhereSnellsLawSays) {
  constexpr double kDepth = 2, kWidth = 8;
  for (const float dispersion : {0.0f, 3.0f, 8.0f}) {
    Scene scene = test::bare_scene(1);
    scene.integrator.kind = IntegratorKind::path, scene.integrator.depth = 4,
    scene.integrator.samples = 20000;
    scene.lights_given = true;
    // At 50 degrees to the surface y = 0, which the ray meets at x = 0.
    const double angle = 50 * std::numbers::pi / 180;
    scene.camera.from = Vec3d{-std::sin(angle), std::cos(angle), 0} * 10, scene.camera.at = {0, 0, 0};
    scene.camera.projection = Projection::orthographic, scene.camera.height = 1e-4;
    PatternTexture pattern;
    pattern.pattern = GradientPattern{{0, 0, 0}, {kWidth, 0, 0}};
    pattern.colors = {{0, 0, 0}, {kWidth, kWidth, kWidth}};
    Texture texture;
    texture.pattern = pattern;
    scene.textures.push_back(texture);
    Material floor = test::glowing({1, 1, 1});
    floor.emission_texture = 0;
    test::add_object(scene, PlaneShape{{0, 1, 0}, 0}, test::add_material(scene, dispersive(dispersion)));
    test::add_object(scene, PlaneShape{{0, 1, 0}, -kDepth}, test::add_material(scene, floor));
    const Picture picture = test::run(scene).picture;
    const char* const planes[] = {"R", "G", "B"};
    for (int k = 0; k < 3; ++k) {
      const double ior = double{dispersed_ior(1.5f, dispersion, k)};
      const double place = kDepth * std::tan(std::asin(std::sin(angle) / ior));
      const double passed = 1 - fresnel(std::cos(angle), ior);
      EXPECT_NEAR(test::value(picture, planes[k], 0, 0), place * passed, 0.02 * place)
          << dispersion << ' ' << k;
    }
  }
}

// A path that carries one channel alone goes on with it.
TEST(Dispersion, PathsKeepTheirChannel) {
  const Material m = dispersive(2);
  for (const float u : {0.0f, 0.3f, 0.5f, 0.999f}) {
    ShadingPoint p;
    p.principled = m.principled->parameters;
    const Color factor = disperse(p, {0, 0, 0.7f}, u);
    EXPECT_EQ(factor, (Color{0, 0, 1}));
    EXPECT_EQ(p.principled->ior, dispersed_ior(1.5f, 2, 2));
  }
  // The mean over choices is what it carries.
  Vec3d mean;
  constexpr int kChoices = 1000;
  for (int i = 0; i < kChoices; ++i) {
    ShadingPoint p;
    p.principled = m.principled->parameters;
    const Color carried{0.2f, 0.5f, 0.3f};
    mean += Vec3d(carried * disperse(p, carried, (i + 0.5f) / kChoices)) / kChoices;
  }
  EXPECT_NEAR(mean.x, 0.2, 2e-3);
  EXPECT_NEAR(mean.y, 0.5, 2e-3);
  EXPECT_NEAR(mean.z, 0.3, 2e-3);
}

// Parallel light that enters a block of glass, and what lies in it.
TEST(Dispersion, PhotonsGoWhereTheirChannelIsBent) {
  constexpr float kDispersion = 4;
  const double sine = std::sin(0.9);
  Scene scene = test::bare_scene(1);
  test::add_object(scene, BoxShape{{-2, -2, -2}, {2, 0, 2}},
                   test::add_material(scene, dispersive(kDispersion)));
  test::add_object(scene, DiskShape{{0, -1, 0}, {0, 1, 0}, 0.5},
                   test::add_material(scene, test::diffuse({1, 1, 1})));
  scene.lights = {DirectionalLight{{sine, -std::cos(0.9), 0}, {1, 1, 1}, 0}};
  const test::PhotonScene photons(scene);
  const TracedPhotons traced = trace_photons(photons.context, photons.source, test::plan_of(40000), 0);
  const PhotonEnergy& e = traced.energy;
  EXPECT_NEAR(e.stored + e.absorbed + e.escaped + e.cut, e.emitted, 2e-3 * e.emitted);
  Vec3d power;
  int direct = 0;
  for (const Photon& p : traced.photons) {
    ASSERT_EQ((p.power.x > 0) + (p.power.y > 0) + (p.power.z > 0), 1);
    const double x = unpack_direction(p.direction).x;
    // Others are mirrored by a face, or came in through a side, where they are bent less.
    if (p.bounces != 1 || x > 0.7) continue;
    const int k = p.power.x > 0 ? 0 : p.power.y > 0 ? 1 : 2;
    const double ior = double{dispersed_ior(1.5f, kDispersion, k)};
    EXPECT_NEAR(x, sine / ior, 1e-3);
    // As much light as the surface lets pass; photons have it per squared index.
    power[k] += double{p.power[k]} * ior * ior / (1 - fresnel(std::cos(0.9), ior));
    ++direct;
  }
  EXPECT_GT(direct, 500);
  EXPECT_NEAR(power.y / power.x, 1, 0.15);
  EXPECT_NEAR(power.z / power.x, 1, 0.15);
}

TEST(Dispersion, GlassInWhiteSurroundingsIsWhite) {
  for (const float roughness : {0.0f, 0.4f}) {
    Scene scene = test::bare_scene(4);
    scene.integrator.kind = IntegratorKind::path, scene.integrator.depth = 40, scene.integrator.samples = 256;
    scene.background = {1, 1, 1};
    Material m = dispersive(4);
    m.principled->parameters.roughness = roughness;
    scene.camera.fov = 8;
    test::add_object(scene, SphereShape{}, test::add_material(scene, m));
    const Picture picture = test::run(scene).picture;
    for (const char* plane : {"R", "G", "B"}) {
      double mean = 0;
      for (std::uint32_t i = 0; i < 16; ++i) mean += double{test::value(picture, plane, i % 4, i / 4)} / 16;
      EXPECT_NEAR(mean, 1, 0.06) << plane << ' ' << roughness;
    }
  }
}

}  // namespace
}  // namespace oktett::dispersion_test
