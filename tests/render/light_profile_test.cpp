/// \file Lamps with profiles: values, flux and direction, and the light that they give.

#include <gtest/gtest.h>

#include <numbers>

#include "core/random.h"
#include "render/light/emitter.h"
#include "render/moments.h"
#include "render/scene_lights.h"
#include "tests/render/photon_support.h"

namespace oktett::light_profile_test {
namespace {

using namespace test;

/// cos(vertical) below the horizon, every degree.
std::shared_ptr<LightProfile> cosine_profile() {
  auto profile = std::make_shared<LightProfile>();
  profile->horizontal = {0};
  for (int i = 0; i <= 90; ++i) {
    profile->vertical.push_back(i);
    profile->values.push_back(static_cast<float>(std::cos(i * std::numbers::pi / 180)));
  }
  return profile;
}

/// Random values on uneven angles.
std::shared_ptr<LightProfile> random_profile(std::uint32_t seed) {
  auto profile = std::make_shared<LightProfile>();
  profile->vertical = {10, 30, 31, 80, 110, 175};
  profile->horizontal = {0, 20, 90, 100, 250, 360};
  for (std::uint32_t i = 0; i < 36; ++i) profile->values.push_back(random_float(seed, i, 0));
  for (std::size_t v = 0; v < 6; ++v) profile->values[30 + v] = profile->values[v];
  return profile;
}

double flux_by_quadrature(const LightProfile& profile) {
  const int steps = 1800;
  double sum = 0;
  for (int i = 0; i < steps; ++i)
    for (int k = 0; k < 720; ++k) {
      const double v = 180 * (i + 0.5) / steps, h = 360 * (k + 0.5) / 720;
      sum += profile_value(profile, v, h) * std::sin(v * std::numbers::pi / 180) *
             (std::numbers::pi / steps) * (2 * std::numbers::pi / 720);
    }
  return sum;
}

TEST(LightProfile, FluxIsTheIntegralOfItsValues) {
  EXPECT_NEAR(profile_flux(*cosine_profile()), std::numbers::pi, 1e-3);
  const LightProfile even{{0, 180}, {0}, {1, 1}};
  EXPECT_NEAR(profile_flux(even), 4 * std::numbers::pi, 1e-12);
  const LightProfile below{{0, 90}, {0, 180, 360}, {1, 1, 0, 0, 1, 1}};
  EXPECT_NEAR(profile_flux(below), std::numbers::pi, 1e-12);
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    const auto profile = random_profile(seed);
    EXPECT_NEAR(profile_flux(*profile), flux_by_quadrature(*profile), 3e-3);
  }
}

TEST(LightProfile, ValuesAreThoseOfTheTableAndLinearBetween) {
  const auto p = random_profile(1);
  for (std::size_t h = 0; h < 6; ++h)
    for (std::size_t v = 0; v < 6; ++v)
      EXPECT_NEAR(profile_value(*p, p->vertical[v], p->horizontal[h]), p->values[h * 6 + v], 1e-7);
  EXPECT_NEAR(profile_value(*p, 20, 10), (p->values[0] + p->values[1] + p->values[6] + p->values[7]) / 4,
              1e-7);
  EXPECT_EQ(profile_value(*p, 9.99, 10), 0);
  EXPECT_EQ(profile_value(*p, 175.01, 10), 0);
  EXPECT_EQ(profile_value(*p, std::nan(""), 10), 0);
}

// Two angles are the fewest between which there is anything to interpolate.
TEST(LightProfile, ValuesOfTwoAnglesAreLinearBetween) {
  const LightProfile turned{{0, 80}, {0}, {1, 0.5f}};
  for (const double h : {0.0, 123.0, 360.0}) {
    EXPECT_EQ(profile_value(turned, 0, h), 1);
    EXPECT_NEAR(profile_value(turned, 20, h), 0.875, 1e-12);
    EXPECT_NEAR(profile_value(turned, 40, h), 0.75, 1e-12);
    EXPECT_NEAR(profile_value(turned, 60, h), 0.625, 1e-12);
    EXPECT_EQ(profile_value(turned, 80, h), 0.5);
    EXPECT_EQ(profile_value(turned, 81, h), 0);
  }
  const LightProfile both{{20, 60}, {0, 360}, {1, 0.5f, 0, 0.25f}};
  EXPECT_EQ(profile_value(both, 20, 0), 1);
  EXPECT_EQ(profile_value(both, 60, 0), 0.5);
  EXPECT_EQ(profile_value(both, 20, 360), 0);
  EXPECT_EQ(profile_value(both, 60, 360), 0.25);
  EXPECT_NEAR(profile_value(both, 40, 180), 0.4375, 1e-12);
  EXPECT_NEAR(profile_value(both, 30, 90), 0.875 * 0.75 + 0.0625 * 0.25, 1e-12);
  EXPECT_NEAR(profile_value(both, 50, 270), 0.625 * 0.25 + 0.1875 * 0.75, 1e-12);
  // Many vertical angles, but one horizontal one.
  const LightProfile bright_ring{{0, 10, 40, 90}, {0}, {0, 1, 0.4f, 0}};
  EXPECT_NEAR(profile_value(bright_ring, 5, 200), 0.5, 1e-7);
  EXPECT_NEAR(profile_value(bright_ring, 25, 10), 0.7, 1e-7);
  EXPECT_NEAR(profile_value(bright_ring, 65, 350), 0.2, 1e-7);
}

TEST(LightProfile, IsAimedAlongItsAxis) {
  const auto down = aim(random_profile(2), {0, -2, 0}, 0);
  const auto at = [](double v, double h) {
    const double s = std::sin(v * std::numbers::pi / 180);
    // Horizontal angles from +x, counter-clockwise as seen from above.
    return Vec3d{s * std::cos(h * std::numbers::pi / 180), -std::cos(v * std::numbers::pi / 180),
                 -s * std::sin(h * std::numbers::pi / 180)};
  };
  for (const double v : {10.5, 50.0, 120.0})
    for (const double h : {0.0, 45.0, 95.0, 200.0, 359.0}) {
      EXPECT_NEAR(down(at(v, h)), profile_value(*down.profile, v, h), 1e-5) << v << ' ' << h;
      // Straight up it is turned by half a turn about x.
      const Vec3d d = at(v, h);
      EXPECT_NEAR(aim(down.profile, {0, 1, 0}, 0)({d.x, -d.y, -d.z}), down(d), 1e-5) << v << ' ' << h;
      const auto turned = aim(down.profile, {0, -1, 0}, 30);
      EXPECT_NEAR(turned(at(v, h)), profile_value(*down.profile, v, h < 30 ? h + 330 : h - 30), 1e-5);
    }
  for (const Vec3d& axis :
       {Vec3d{0, 1, 0}, Vec3d{1, 2, 3}, Vec3d{-1, 0, 0}, Vec3d{1e-9, 1, 0}, Vec3d{0, -1, 1e-9}}) {
    const AimedProfile p = aim(cosine_profile(), axis, 77);
    EXPECT_NEAR(length(p.down), 1, 1e-6);
    EXPECT_NEAR(length(p.zero), 1, 1e-6);
    EXPECT_NEAR(dot(p.down, p.zero), 0, 1e-6);
    EXPECT_NEAR(p(axis), 1, 1e-6) << axis.x;
    EXPECT_EQ(p(-axis), 0);
  }
}

/// A camera of one pixel at the origin of a white floor, y = 0.
Scene floor_scene(const Light& light, IntegratorKind kind) {
  Scene scene = bare_scene(1);
  scene.integrator.kind = kind;
  scene.camera.from = {0, 0.4, 5}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 0.001;
  add_object(scene, DiskShape{{0, 0, 0}, {0, 1, 0}, 0.5}, add_material(scene, diffuse({1, 1, 1})));
  scene.lights = {light};
  return scene;
}

// A floor under a lamp whose intensity goes with the cosine: color cos^2(angle) / d^2.
TEST(LightProfile, LightsAFloorAsBothIntegratorsSay) {
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::whitted})
    for (const bool layers : {false, true})
      for (const double x : {0.0, 1.0, -3.0}) {
        const double square = x * x + 4, want = 3 * 4 / square / square;
        const auto set = [&](RenderOptions& o) { o.data_layers = layers; };
        PointLight point{{x, 2, 0}, {3, 3, 3}, true};
        point.profile = cosine_profile();
        EXPECT_NEAR(value(run(floor_scene(point, kind), set).picture, "G", 0, 0), want, 1e-3 * want);
        // A spot that looks at the origin.
        SpotLight spot{{x, 2, 0}, {-x, -2, 0}, {3, 3, 3}};
        spot.profile = cosine_profile();
        const double towards = 3 * 2 / std::sqrt(square) / square;
        EXPECT_NEAR(value(run(floor_scene(spot, kind), set).picture, "G", 0, 0), towards, 1e-3 * towards);
        spot.direction = {x, 2, 0};
        EXPECT_EQ(value(run(floor_scene(spot, kind), set).picture, "G", 0, 0), 0);
      }
}

TEST(LightProfile, PhotonsCarryItsFlux) {
  Scene scene = bare_scene(1);
  add_object(scene, PlaneShape{{0, 1, 0}, -1}, add_material(scene, mirror()));
  PointLight point{{0, 2, 0}, {1, 1, 1}, true};
  point.profile = random_profile(3);
  scene.lights = {point};
  const PhotonScene photons(scene);
  double sum = 0;
  const std::uint32_t count = 1 << 18;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto d = [&](std::uint32_t k) { return static_cast<double>(random_float(3, i, k)); };
    const auto start = photons.source.emit(d(0), {d(1), d(2)}, {d(3), d(4)});
    if (start) sum += double{start->power.y};
  }
  EXPECT_NEAR(sum / count, std::numbers::pi * profile_flux(*point.profile),
              0.01 * std::numbers::pi * profile_flux(*point.profile));
}

// A lamp that is turned shows its profile turned: what it gave along d it gives along the turned d.
TEST(AimedProfile, TurnsWithItsLamp) {
  const std::shared_ptr<const LightProfile> profile = random_profile(3);
  PointLight point;
  point.profile = profile, point.rotation = 25;
  SpotLight spot;
  spot.profile = profile, spot.rotation = -70, spot.direction = {1, -2, 0.5};
  const auto number = [](std::uint32_t i, std::uint32_t k) { return double{random_float(8, i, k)}; };
  for (std::uint32_t i = 0; i < 50; ++i) {
    Affine motion = Affine::rotation({360 * number(i, 0), 360 * number(i, 1), 360 * number(i, 2)});
    if (i == 0) motion = Affine::rotation({180, 0, 0});
    if (i == 1) motion = Affine::rotation({0, 90, 0});
    const AimedProfile turned_point = profile_of(std::get<PointLight>(moved_light(motion, point)));
    const AimedProfile turned_spot = profile_of(std::get<SpotLight>(moved_light(motion, spot)));
    for (std::uint32_t k = 3; k < 40; k += 3) {
      const Vec3d d = normalize(Vec3d{number(i, k) - 0.5, number(i, k + 1) - 0.5, number(i, k + 2) - 0.5});
      EXPECT_NEAR(turned_point(motion.vector(d)), profile_of(point)(d), 1e-5f) << i;
      EXPECT_NEAR(turned_spot(motion.vector(d)), profile_of(spot)(d), 1e-5f) << i;
    }
  }
}

}  // namespace
}  // namespace oktett::light_profile_test
