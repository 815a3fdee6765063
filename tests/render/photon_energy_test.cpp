/// \file The power of photons: what lights send, and where it ends.

#include <gtest/gtest.h>
#include <numbers>

#include "core/random.h"
#include "tests/render/photon_support.h"

namespace oktett::photon_energy_test {
namespace {

using namespace test;

/// A white room, of half edge 5, with a ball of radius 0.5 about the origin in it.
Scene room_with_ball(const Material& ball) {
  Scene scene = bare_scene(1);
  add_object(scene, BoxShape{{-5, -5, -5}, {5, 5, 5}}, add_material(scene, diffuse({1, 1, 1})));
  add_object(scene, SphereShape{{0, 0, 0}, 0.5}, add_material(scene, ball));
  return scene;
}

/// Radius of the ball to which photons are sent: that around the box around the glass ball.
double target_radius() { return 0.5 * std::sqrt(3.0) * 1.0001; }

struct MeanAndError {
  double mean = 0, error = 0;
};

/// The mean power of independent photons.
MeanAndError emitted(const PhotonSource& source, std::uint32_t photons = 200000) {
  double sum = 0, squares = 0;
  for (std::uint32_t i = 0; i < photons; ++i) {
    const auto d = [&](std::uint32_t k) { return static_cast<double>(random_float(3, i, k)); };
    const auto start = source.emit(d(0), {d(1), d(2)}, {d(3), d(4)});
    const double power = start ? double{start->power.y} : 0;
    sum += power, squares += power * power;
  }
  const double mean = sum / photons;
  return {mean, std::sqrt(std::max(0.0, squares / photons - mean * mean) / photons)};
}

/// The flux of a small piece of area through the target, which is wholly on its bright side: radiance times
/// the integral of the cosine over the cone, pi sin^2(half angle) cos(angle to the normal).
double flux_of_piece(const Vec3d& from, const Vec3d& normal, double r) {
  const double square = dot(from, from);
  return std::numbers::pi * r * r / square * dot(normal, -from) / std::sqrt(square);
}

void expect_power(const Scene& scene, double want, const char* what) {
  const PhotonScene photons(scene);
  const MeanAndError got = emitted(photons.source);
  EXPECT_NEAR(got.mean, want, 3.5 * got.error + 1e-4 * want) << what;
  EXPECT_LT(got.error, 0.02 * want) << what;
}

TEST(PhotonEnergy, LightsSendTheirPowerToTheTarget) {
  const double r = target_radius();
  const double cap = 2 * std::numbers::pi * (1 - std::sqrt(1 - r * r / 9));  // of a place at distance 3
  Scene scene = room_with_ball(glass(1.5f));
  const auto light = [&](Light l) {
    Scene s = scene;
    s.lights = {std::move(l)};
    return s;
  };
  const auto lamp = [&](Shape shape, bool both = false) {
    Scene s = scene;
    Material m = glowing({1, 2, 3});
    m.emits_behind = both;
    add_object(s, std::move(shape), add_material(s, m));
    return s;
  };
  expect_power(light(PointLight{{0, 3, 0}, {1, 2, 3}, true}), 2 * std::numbers::pi * cap, "point");
  expect_power(light(PointLight{{0, 0.1, 0}, {1, 2, 3}, true}), 2 * std::numbers::pi * 4 * std::numbers::pi,
               "point inside");
  // A spot with a sharp edge whose cone is wider, and one whose cone is narrower than the target.
  expect_power(light(SpotLight{{0, 3, 0}, {0, -1, 0}, {1, 2, 3}, 60, 60}), 2 * std::numbers::pi * cap,
               "wide spot");
  expect_power(light(SpotLight{{0, 3, 0}, {0, -1, 0}, {1, 2, 3}, 5, 5}),
               2 * std::numbers::pi * 2 * std::numbers::pi * (1 - std::cos(5 * std::numbers::pi / 180)),
               "narrow spot");
  // The edge of a soft one counts half.
  expect_power(light(SpotLight{{0, 3, 0}, {0, -1, 0}, {1, 2, 3}, 2, 6}),
               2 * std::numbers::pi * 2 * std::numbers::pi *
                   (1 - (std::cos(2 * std::numbers::pi / 180) + std::cos(6 * std::numbers::pi / 180)) / 2),
               "soft spot");
  expect_power(light(DirectionalLight{{1, -2, 3}, {1, 2, 3}, 0}),
               2 * std::numbers::pi * std::numbers::pi * r * r, "parallel");
  expect_power(light(DirectionalLight{{1, -2, 3}, {1, 2, 3}, 0.5}),
               2 * std::numbers::pi * std::numbers::pi * r * r, "sun disk");
  auto picture = std::make_shared<EnvironmentPicture>();
  picture->width = 4, picture->height = 2;
  picture->pixels.assign(8, {1, 2, 3});
  expect_power(light(EnvironmentLight{picture, 0, {1, 1, 1}}),
               2 * 4 * std::numbers::pi * std::numbers::pi * r * r, "environment");
  picture->pixels[2] = {50, 200, 0};
  {
    const PhotonScene uneven(light(EnvironmentLight{picture, 30, {1, 1, 1}}));
    // The mean radiance by quadrature.
    double sum = 0;
    const int steps = 200;
    for (int i = 0; i < steps; ++i)
      for (int k = 0; k < 2 * steps; ++k) {
        const double theta = std::numbers::pi * (i + 0.5) / steps, phi = std::numbers::pi * (k + 0.5) / steps;
        const Vec3f d(
            Vec3d{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)});
        sum += double{uneven.lights.set().environment_radiance(d).y} * std::sin(theta) * std::numbers::pi *
               std::numbers::pi / (steps * steps);
      }
    expect_power(uneven.scene, sum * std::numbers::pi * r * r, "uneven environment");
  }
  // Small lamps, by the closed form for their middle, and the hidden halves of wide ones.
  const Vec3d far{0, 3, 0};
  const double piece = flux_of_piece(far, {0, -1, 0}, r);
  const auto corner = [](double x, double z) { return Vec3d{0.01 * x, 3, 0.01 * z}; };
  expect_power(lamp(DiskShape{far, {0, -1, 0}, 0.01}), 2 * std::numbers::pi * 1e-4 * piece, "disk");
  expect_power(lamp(DiskShape{far, {0, 1, 0}, 0.01}, true), 2 * std::numbers::pi * 1e-4 * piece,
               "both sides");
  expect_power(lamp(PolygonShape{{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)}}, true),
               2 * 1e-4 * piece, "rectangle");
  expect_power(lamp(TriangleShape{{corner(0, 0), corner(1, 0), corner(0, 1)}}, true), 1e-4 * piece,
               "triangle");
  // A ball far away is seen as a disk.
  expect_power(lamp(SphereShape{{0, 4.5, 0}, 0.02}),
               2 * std::numbers::pi * 4e-4 * 2 * std::numbers::pi * (1 - std::sqrt(1 - r * r / (4.5 * 4.5))),
               "sphere");
}

TEST(PhotonEnergy, WithoutBoundsLampsSendAllTheirPower) {
  Scene scene = bare_scene(1);
  add_object(scene, PlaneShape{{0, 1, 0}, -1}, add_material(scene, mirror()));
  const auto lamp = [&](Shape shape, bool both) {
    Scene s = scene;
    Material m = glowing({1, 2, 3});
    m.emits_behind = both;
    add_object(s, std::move(shape), add_material(s, m));
    return s;
  };
  expect_power(lamp(SphereShape{{0, 4, 0}, 0.3}, false), 2 * std::numbers::pi * 4 * std::numbers::pi * 0.09,
               "sphere");
  expect_power(lamp(SphereShape{{0, 4, 0}, 0.3}, true),
               2 * 2 * std::numbers::pi * 4 * std::numbers::pi * 0.09, "sphere, both sides");
  expect_power(lamp(DiskShape{{0, 4, 0}, {0, -1, 0}, 0.3}, false),
               2 * std::numbers::pi * std::numbers::pi * 0.09, "disk");
  Scene parallel = scene;
  parallel.lights = {DirectionalLight{}};
  const PhotonScene none(parallel);
  EXPECT_TRUE(none.source.empty());
  EXPECT_FALSE(none.source.brings_distant());
}

/// Expects that all power is accounted for, and returns the account.
PhotonEnergy expect_conserved(const Scene& scene, std::uint32_t depth = 8) {
  const PhotonScene photons(scene);
  const PhotonEnergy e = trace_photons(photons.context, photons.source, plan_of(100000, depth), 0).energy;
  EXPECT_GT(e.emitted, 0);
  // Only rounding and Russian roulette are left.
  EXPECT_NEAR(e.stored + e.absorbed + e.escaped + e.cut, e.emitted, 2e-3 * e.emitted);
  return e;
}

TEST(PhotonEnergy, WhatIsEmittedIsStoredAbsorbedOrEscapes) {
  const Light lights[] = {
      PointLight{{0, 3, 0}, {1, 1, 1}, true}, SpotLight{{0, 3, 0.2}, {0, -1, 0}, {1, 1, 1}, 20, 40},
      DirectionalLight{{1, -2, 0.5}, {1, 1, 1}, 0}, DirectionalLight{{1, -2, 0.5}, {1, 1, 1}, 3}, SkyLight{}};
  for (const Light& light : lights) {
    // Clear glass over nothing: all escapes.
    Scene scene = bare_scene(1);
    add_object(scene, SphereShape{{0, 0, 0}, 0.5}, add_material(scene, glass(1.5f)));
    scene.lights = {light};
    PhotonEnergy e = expect_conserved(scene, 64);
    EXPECT_NEAR(e.escaped, e.emitted, 1e-4 * e.emitted) << light.index();
    EXPECT_EQ(e.stored, 0);
    // Half of the light is taken by a mirror.
    Material half = mirror();
    half.reflection = 0.5f;
    scene.materials[0] = half;
    e = expect_conserved(scene);
    EXPECT_GT(e.absorbed, 0.1 * e.emitted) << light.index();
    // Over a floor.
    scene.materials[0] = glass(1.5f);
    add_object(scene, PlaneShape{{0, 1, 0}, -0.7}, add_material(scene, diffuse({1, 1, 1})));
    e = expect_conserved(scene);
    EXPECT_GT(e.stored, 0.1 * e.emitted) << light.index();
  }
}

// In a room of grey mirrors all light ends at their walls, most of it after Russian roulette has begun.
TEST(PhotonEnergy, RouletteKeepsTheMean) {
  Material grey = mirror();
  grey.reflection = 0.7f;
  Scene scene = bare_scene(1);
  add_object(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}}, add_material(scene, grey));
  scene.lights = {PointLight{{0.1, 0.2, 0.3}, {1, 1, 1}, true}};
  const PhotonScene photons(scene);
  const PhotonEnergy e = trace_photons(photons.context, photons.source, plan_of(100000, 64), 0).energy;
  EXPECT_NEAR(e.absorbed, e.emitted, 5e-3 * e.emitted);
  EXPECT_LT(e.cut, 1e-3 * e.emitted);
}

// Light runs to and fro between two parallel mirrors. Their shading normals lean by two degrees against it,
// so that each of six bounces makes it steeper by four, or along with it. The factors of the normals are
// ratios of cosines; their product is that of the last and the first angle. What grows is never lost.
TEST(PhotonEnergy, RouletteKeepsWhatNormalsAdd) {
  const double degree = std::numbers::pi / 180;
  for (const bool grows : {true, false}) {
    const double lean = (grows ? 2 : -2) * degree, first = (grows ? 60 : 36) * degree;
    const double want = std::cos(first - 12 * lean) / std::cos(first);
    Scene scene = bare_scene(1);
    const std::uint32_t shiny = add_material(scene, mirror()),
                        white = add_material(scene, diffuse({1, 1, 1}));
    for (const double up : {1.0, -1.0}) {
      const float y = up > 0 ? 0 : 1;
      const Vec3f across{0, 0, up > 0 ? 1.0f : -1.0f};
      auto mesh = parallelogram({0, y, -across.z / 2}, across, {6.9f, 0, 0});
      mesh->normals.push_back(Vec3f(Vec3d{-std::sin(lean), up * std::cos(lean), 0}));
      for (std::size_t i = 0; i < mesh->indices.size(); ++i) mesh->normal_indices.push_back(0);
      MeshShape shape;
      shape.mesh = mesh;
      add_object(scene, shape, shiny);
    }
    add_object(scene, PlaneShape{{-1, 0, 0}, -6.9}, white);
    scene.lights = {SpotLight{{0, 0.5, 0}, {std::sin(first), -std::cos(first), 0}, {1, 1, 1}, 0.1, 0.1}};
    const PhotonScene photons(scene);
    const TracedPhotons traced = trace_photons(photons.context, photons.source, plan_of(100000), 0);
    ASSERT_FALSE(traced.photons.empty());
    for (const Photon& p : traced.photons) ASSERT_EQ(p.bounces, 6);
    // Of the photons that may be lost, three of four are left: that is 0.2 % noise.
    const double stored = traced.energy.stored / traced.energy.emitted;
    EXPECT_NEAR(stored, want, (grows ? 1e-3 : 1e-2) * want) << grows;
    EXPECT_EQ(traced.energy.escaped, 0);
  }
}

// What a mirror ball in a room sends to the walls is what falls on it: a closed form.
TEST(PhotonEnergy, AMirrorBallStoresWhatFallsOnIt) {
  Scene scene = room_with_ball(mirror());
  scene.lights = {PointLight{{0, 3, 0}, {1, 1, 1}, true}};
  PhotonEnergy e = expect_conserved(scene);
  const double cap = 2 * std::numbers::pi * (1 - std::sqrt(1 - 0.25 / 9));
  EXPECT_NEAR(e.stored, std::numbers::pi * cap, 3 * std::numbers::pi * cap / std::sqrt(0.3 * 100000));
  EXPECT_EQ(e.escaped, 0);
  // All of the light that clear glass takes in it gives back.
  scene = room_with_ball(glass(1.5f));
  scene.lights = {PointLight{{0, 3, 0}, {1, 1, 1}, true}};
  e = expect_conserved(scene, 64);
  EXPECT_NEAR(e.stored, std::numbers::pi * cap, 3 * std::numbers::pi * cap / std::sqrt(0.3 * 100000));
}

// Light that leaves a lamp within a block of glass and the photons within are scaled as radiance is.
TEST(PhotonEnergy, PowerInGlassIsDividedByTheSquareOfItsIndex) {
  // A floor within a block of glass, under a parallel beam.
  Scene scene = bare_scene(1);
  add_object(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}}, add_material(scene, glass(2)));
  add_object(scene, DiskShape{{0, 0, 0}, {0, 1, 0}, 0.5}, add_material(scene, diffuse({1, 1, 1})));
  scene.lights = {DirectionalLight{{0, -1, 0}, {1, 1, 1}, 0}};
  const PhotonScene photons(scene);
  const TracedPhotons traced = trace_photons(photons.context, photons.source, plan_of(100000, 1), 0);
  double sum = 0;
  for (const Photon& p : traced.photons) sum += double{p.power.y};
  // Irradiance pi passes with 1 - 1/9, on an area of pi / 4, from above alone.
  const double want = std::numbers::pi * (8.0 / 9) * (std::numbers::pi / 4) / 4;
  EXPECT_NEAR(sum, want, 0.02 * want);
}

}  // namespace
}  // namespace oktett::photon_energy_test
