// Fog against Beer's law and quadrature, and what POV-Ray 3.7.0.10 shows.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/fog.h"
#include "tests/render/test_scenes.h"

namespace oktett::fog_test {
namespace {

using namespace test;

Fog fog_of(double distance, const Color& color) {
  Fog fog;
  fog.distance = distance, fog.color = color;
  return fog;
}

/// A wall at z = -5 that shows `wall`, seen from z = 5 straight ahead.
Scene wall_scene(const Color& wall, const Fog& fog) {
  Scene scene = bare_scene(1);
  scene.camera.projection = Projection::orthographic, scene.camera.height = 1e-3;
  scene.camera.from = {0, 0, 5}, scene.camera.at = {0, 0, 0};
  add_object(scene, PlaneShape{{0, 0, 1}, -5}, add_material(scene, glowing(wall)));
  scene.fogs = {fog};
  return scene;
}

Color shown(const Scene& scene) { return color(run(scene).picture, 0, 0); }

void expect_color(const Color& found, const Vec3d& want, double tolerance = 1e-6) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], want[k], tolerance) << k;
}

TEST(Fog, VeilsByTheWayThroughIt) {
  const Vec3d wall{0.9, 0.5, 0.2}, fog{0.1, 0.3, 0.7};
  for (const double distance : {3.0, 8.0, 40.0}) {
    const double left = std::exp(-10 / distance);
    expect_color(shown(wall_scene(Color(wall), fog_of(distance, Color(fog)))),
                 wall * left + fog * (1 - left));
  }
}

// Of a wall 5 away, with the distance 8.
TEST(Fog, IsThatOfPovRay) {
  const auto at = [](double filter, double transmit) {
    Fog fog = fog_of(8, {0.1f, 0.3f, 0.7f});
    fog.filter = filter, fog.transmit = transmit;
    const Veil p = pass_fogs({&fog, 1}, {0, 0, 0}, {0, 0, 1}, 5);
    return Color{0.9f, 0.5f, 0.2f} * p.left + p.light;
  };
  constexpr double kNear = 2e-5;
  expect_color(at(0, 0.3), {0.52821, 0.40705, 0.43236}, kNear);
  expect_color(at(0, 0.7), {0.66, 0.44, 0.35}, kNear);
  expect_color(at(0.5, 0), {0.31142, 0.31337, 0.41631}, kNear);
  expect_color(at(1, 0), {0.09465, 0.21971, 0.40026}, kNear);
  expect_color(at(0.4, 0.7), {0.4332, 0.342, 0.3332}, kNear);
  // Two: the light of both.
  const Fog two[] = {fog_of(8, {0.1f, 0.3f, 0.7f}), fog_of(3, {0.8f, 0.1f, 0})};
  const Veil p = pass_fogs(two, {0, 0, 0}, {0, 0, 1}, 5);
  expect_color(Color{0.9f, 0.5f, 0.2f} * p.left + p.light, {0.78636, 0.27108, 0.34554}, kNear);
}

/// The part of light that fog on the ground leaves, by summing up its density.
double left_by_sum(const Fog& fog, const Vec3d& origin, const Vec3d& direction, double distance) {
  constexpr int kSteps = 200000;
  const Vec3d up = normalize(fog.up);
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double h = dot(origin + direction * (distance * (i + 0.5) / kSteps), up) - fog.offset;
    const double x = h / fog.altitude;
    sum += h > 0 ? 1 / (1 + x * x) : 1;
  }
  return std::exp(-sum / kSteps * distance / fog.distance);
}

TEST(Fog, OnTheGroundThinsOutWithHeight) {
  for (const double altitude : {0.1, 0.7, 20.0})
    for (const double start : {-2.0, 0.5, 3.0})
      for (const Vec3d& way : {Vec3d{1, 0, 0}, Vec3d{1, 1e-7, 0}, Vec3d{1, 0.3, 1}, Vec3d{0, -1, 0.2}}) {
        Fog fog = fog_of(8, {0, 0, 0});
        fog.altitude = altitude, fog.offset = 0.5, fog.up = {0, 3, 0};
        const Vec3d direction = normalize(way);
        const Veil p = pass_fogs({&fog, 1}, {2, start, 1}, direction, 7);
        EXPECT_NEAR(p.left.x, left_by_sum(fog, {2, start, 1}, direction, 7), 1e-5)
            << altitude << ' ' << start << ' ' << way.y;
      }
}

TEST(Fog, OnTheGroundLetsTheSkyShow) {
  Fog fog = fog_of(8, {0, 0, 0});
  fog.altitude = 1;
  const Vec3d upwards = normalize(Vec3d{0, 0.5, 1});
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(pass_fogs({&fog, 1}, {0, 0, 0}, upwards, kInfinity).left.x, 0.64464, 1e-5);  // POV-Ray
  EXPECT_NEAR(pass_fogs({&fog, 1}, {0, 0, 0}, upwards, kInfinity).left.x,
              left_by_sum(fog, {0, 0, 0}, upwards, 1e4), 1e-4);
  for (const Vec3d& way : {Vec3d{0, 0, 1}, Vec3d{0, -0.5, 1}})
    EXPECT_EQ(pass_fogs({&fog, 1}, {0, 0, 0}, normalize(way), kInfinity).left.x, 0);
}

// POV-Ray 3.7.0.10: the optical depth is that of even fog times 1 - turb_depth * min(1, clouds) * e^(-way /
// distance), and the clouds are those in the middle of the way. With clouds of 0.8311 there, and of 0.117, it
// shows the factors 1 - 0.75205 on a way of 1/10 of the distance and 1 - 0.07831 on one of 4/10.
TEST(Fog, IsThinnerWhereItHasClouds) {
  const auto left = [](double part, const Vec3d& amount, const Vec3d& from, const Vec3d& direction) {
    Fog fog = fog_of(8, {0, 0, 0});
    fog.turbulence = amount, fog.turbulence_depth = part;
    return double{pass_fogs({&fog, 1}, from, direction, 4).left.x};
  };
  const Vec3d ahead{0, 0, 1}, one{1, 1, 1};
  const double even = std::exp(-0.5);
  double least = 1, most = 0;
  for (int i = 0; i < 50; ++i) {
    const Vec3d from{0.37 * i, 1.3 - 0.21 * i, 0.11 * i * i};
    EXPECT_NEAR(left(0, one, from, ahead), even, 1e-6);
    const double whole = left(1, one, from, ahead);
    EXPECT_NEAR(left(0.5, one, from, ahead), std::sqrt(even * whole), 1e-6);
    // From the other end, and on another way with the same middle.
    EXPECT_NEAR(left(1, one, from + ahead * 4, ahead * -1), whole, 1e-6);
    EXPECT_NEAR(left(1, one, from + Vec3d{-2, 0, 2}, {1, 0, 0}), whole, 1e-6);
    // An amount makes places that many times as far apart.
    const Vec3d middle = from + ahead * 2;
    EXPECT_NEAR(left(1, {2, 2, 2}, middle / 2 - ahead * 2, ahead), whole, 1e-6);
    least = std::min(least, whole), most = std::max(most, whole);
  }
  EXPECT_GE(least, even);
  EXPECT_LE(most, 1);
  EXPECT_GT(most - least, 0.05);
}

TEST(Fog, HasTheLessCloudsTheDenserItIs) {
  EXPECT_NEAR(0.8311 * std::exp(-0.1), 0.75205, 2e-4);
  EXPECT_NEAR(0.117 * std::exp(-0.4), 0.07831, 2e-4);
  const auto taken = [](double distance) {
    Fog fog = fog_of(distance, {0, 0, 0});
    fog.turbulence = {1, 1, 1}, fog.turbulence_depth = 1;
    const Veil p = pass_fogs({&fog, 1}, {0.3, 0.7, 0.1}, {0, 0, 1}, 4);
    return 1 + std::log(double{p.left.x}) * distance / 4;
  };
  for (const double distance : {5.0, 10.0, 40.0})
    EXPECT_NEAR(taken(distance) / std::exp(-4 / distance), taken(20) / std::exp(-0.2), 1e-4) << distance;
  EXPECT_GT(taken(20), 0.01);
}

TEST(Fog, HidesTheBackground) {
  Scene scene = wall_scene({0, 0, 0}, fog_of(8, {0.1f, 0.3f, 0.7f}));
  scene.objects.clear();
  scene.background = {1, 0, 0};
  expect_color(shown(scene), {0.1, 0.3, 0.7});
  scene.fogs[0].transmit = 0.4;
  expect_color(shown(scene), {0.46, 0.18, 0.42});
  EXPECT_EQ(value(run(scene).picture, "A", 0, 0), 1);
}

/// Each part of a way counts for itself, as the least part that is left shows.
TEST(Fog, VeilsMirroredRays) {
  Fog fog = fog_of(8, {0, 0, 0});
  fog.transmit = 0.6;
  Scene scene = wall_scene({0, 0, 0}, fog);
  scene.objects.clear();
  add_object(scene, PlaneShape{{0, 0, 1}, 0}, add_material(scene, mirror()));
  scene.background = {1, 1, 1};
  expect_color(shown(scene), Vec3d{1, 1, 1} * 0.36);
  scene.fogs[0].transmit = 0;
  add_object(scene, DiskShape{{0, 0, 8}, {0, 0, 1}, 1}, add_material(scene, glowing({1, 1, 1})));
  expect_color(shown(scene), Vec3d{1, 1, 1} * std::exp(-13.0 / 8));
}

TEST(Fog, IsNotInSolidsThatAreNotHollow) {
  for (const bool hollow : {false, true}) {
    Scene scene = wall_scene({1, 1, 1}, fog_of(8, {0, 0, 0}));
    Material clear = glass(1);
    clear.filter = Color{1, 1, 1};
    add_object(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}}, add_material(scene, clear));
    scene.objects.back().hollow = hollow;
    expect_color(shown(scene), Vec3d{1, 1, 1} * std::exp((hollow ? -10 : -8) / 8.0), 1e-5);
    // Around the camera and all there is.
    scene.objects.back().shape = BoxShape{{-90, -90, -90}, {90, 90, 90}};
    expect_color(shown(scene), Vec3d{1, 1, 1} * (hollow ? std::exp(-10 / 8.0) : 1), 1e-5);
  }
}

// POV-Ray 3.7.0.10 shows these colours of a white floor, seen from 0.05 above, of lamps 5 above it that have
// `media_attenuation`.
TEST(Fog, TakesLightFromLampsThatSaySo) {
  const auto floor = [](const Light& light, const Fog& fog, bool dimmed) {
    Scene scene = bare_scene(1);
    scene.camera.projection = Projection::orthographic, scene.camera.height = 1e-3;
    scene.camera.from = {0, 0.05, 0}, scene.camera.at = {0, 0, 0}, scene.camera.up = {0, 0, 1};
    add_object(scene, PlaneShape{{0, 1, 0}, 0}, add_material(scene, diffuse({1, 1, 1})));
    scene.lights = {light}, scene.light_traits.resize(1);
    scene.light_traits[0].dimmed_by_fog = dimmed;
    scene.fogs = {fog};
    return shown(scene);
  };
  constexpr double kNear = 1e-3;
  const PointLight lamp{{0, 5, 0}};
  Fog fog = fog_of(10, {0, 0, 0});
  expect_color(floor(lamp, fog, false), {0.9951, 0.9951, 0.9951}, kNear);
  expect_color(floor(lamp, fog, true), {0.6035, 0.6035, 0.6035}, kNear);
  // Of a parallel light the way to the plane of its place, here at 45 degrees.
  DirectionalLight slanting{{0, -1, -1}};
  slanting.from = Vec3d{0, 5, 0};
  expect_color(floor(slanting, fog, true), {0.4939, 0.4939, 0.4939}, kNear);
  slanting.from.reset();
  expect_color(floor(slanting, fog, true), {0, 0, 0}, kNear);
  fog.color = {1, 0, 0}, fog.filter = 0.5;
  expect_color(floor(lamp, fog, true), {0.6084, 0.1509, 0.1509}, kNear);
  fog.filter = 0, fog.transmit = 0.8;
  expect_color(floor(lamp, fog, true), {0.8008, 0.7959, 0.7959}, kNear);
  Fog ground = fog_of(10, {0, 0, 0});
  ground.altitude = 1, ground.offset = 1;
  expect_color(floor(lamp, ground, true), {0.7886, 0.7886, 0.7886}, kNear);
}

TEST(Fog, TakesNoLightFromLamps) {
  Scene scene = wall_scene({0, 0, 0}, fog_of(8, {0, 0, 0}));
  scene.objects.clear();
  add_object(scene, PlaneShape{{0, 0, 1}, 0}, add_material(scene, diffuse({1, 1, 1})));
  scene.lights = {PointLight{{0, 0, 30}, {1, 1, 1}}};
  expect_color(shown(scene), Vec3d{1, 1, 1} * std::exp(-5.0 / 8), 1e-5);
}

}  // namespace
}  // namespace oktett::fog_test
