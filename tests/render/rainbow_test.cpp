// Rainbows against what POV-Ray 3.7.0.10 shows.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "render/rainbow.h"
#include "tests/render/test_scenes.h"

namespace oktett::rainbow_test {
namespace {

using namespace test;

Vec3d direction_at(double degrees, double turn = 0) {
  const double a = degrees * (std::numbers::pi / 180), t = turn * (std::numbers::pi / 180);
  return {std::sin(a) * std::sin(t), std::sin(a) * std::cos(t), std::cos(a)};
}

/// About the z axis, from 20 to 40 degrees.
Rainbow bow_of(std::vector<RainbowColor> colors) {
  Rainbow bow;
  bow.direction = {0, 0, 2}, bow.angle = 30, bow.width = 20, bow.distance = 3;
  bow.colors = std::move(colors);
  return bow;
}

Veil pass(const Rainbow& bow, double degrees, double distance, double turn = 0) {
  return pass_rainbows({&bow, 1}, direction_at(degrees, turn), distance);
}

void expect_color(const Color& found, const Vec3d& want) {
  constexpr double kNear = 4e-4;  // of numbers of 16 bits
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], want[k], kNear) << k;
}

// Before black, from red to green.
TEST(Rainbow, ColoursChangeWithTheAngle) {
  const Rainbow bow = bow_of({{0, {1, 0, 0}}, {1, {0, 1, 0}}});
  expect_color(pass(bow, 39.63, 2.597).light, {0.0107, 0.5684, 0});
  expect_color(pass(bow, 33.90, 2.410).light, {0.1685, 0.3835, 0});
  expect_color(pass(bow, 21.34, 2.147).light, {0.4771, 0.0342, 0});
  for (const double outside : {0.0, 19.9, 40.1, 120.0}) {
    expect_color(pass(bow, outside, 100).light, {0, 0, 0});
    expect_color(pass(bow, outside, 100).left, {1, 1, 1});
  }
}

// Of one colour, on a way on which 0.5464 of the bow is seen.
TEST(Rainbow, FiltersAndTransmitsWhatIsBehind) {
  const double distance = -3 * std::log(1 - 0.5464);
  const auto veil = [&](double filter, double transmit, const Color& color = {0, 0.5f, 1}) {
    return pass(bow_of({{0, color, transmit, filter}}), 30, distance);
  };
  expect_color(veil(0, 0).left, {0.4536, 0.4534, 0.4536});
  expect_color(veil(0, 0).light, {0, 0.2732, 0.5464});
  expect_color(veil(0.5, 0).left, {0.3296, 0.3918, 0.4536});
  expect_color(veil(0.5, 0).light, {0, 0.2732, 0.5464});
  expect_color(veil(0, 0.5).left, {0.5, 0.5, 0.5});
  expect_color(veil(0, 0.5).light, {0, 0.25, 0.5});
  expect_color(veil(1, 0).left, {0.2057, 0.3298, 0.4536});
  expect_color(veil(0.5, 0, {0.5f, 0.5f, 0.5f}).left, {0.3918, 0.3918, 0.3918});
}

TEST(Rainbow, MayBeAnArc) {
  Rainbow bow = bow_of({{0, {1, 1, 1}}});
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  bow.arc = 120;
  for (const double turn : {0.0, 59.0, -59.0}) expect_color(pass(bow, 30, kInfinity, turn).light, {1, 1, 1});
  for (const double turn : {61.0, -61.0, 180.0})
    expect_color(pass(bow, 30, kInfinity, turn).light, {0, 0, 0});
  // Half of the way between both the square of a half.
  bow.falloff_arc = 80;
  expect_color(pass(bow, 30, kInfinity, 39).light, {1, 1, 1});
  expect_color(pass(bow, 30, kInfinity, -50).light, {0.25, 0.25, 0.25});
}

// Fog lies before it, and solids that are not hollow keep it out.
TEST(Rainbow, LiesBehindFog) {
  Scene scene = bare_scene(1);
  scene.camera.projection = Projection::orthographic, scene.camera.height = 1e-3;
  scene.camera.from = {0, 0, 5}, scene.camera.at = {0, 0, 0};
  add_object(scene, PlaneShape{{0, 0, 1}, -5}, add_material(scene, glowing({1, 1, 1})));
  Rainbow bow = bow_of({{0, {1, 0, 0}}});
  bow.direction = {0, 0, -1}, bow.angle = 0, bow.distance = 10;
  scene.rainbows = {bow};
  const double bows = std::exp(-1.0);
  Color shown = color(run(scene).picture, 0, 0);
  EXPECT_NEAR(shown.x, 1, 1e-5);
  EXPECT_NEAR(shown.y, bows, 1e-5);
  Fog fog;
  fog.distance = 8, fog.color = {0, 0, 1};
  scene.fogs = {fog};
  shown = color(run(scene).picture, 0, 0);
  const double fogs = std::exp(-10 / 8.0);
  EXPECT_NEAR(shown.x, fogs, 1e-5);
  EXPECT_NEAR(shown.y, bows * fogs, 1e-5);
  EXPECT_NEAR(shown.z, bows * fogs + 1 - fogs, 1e-5);
}

}  // namespace
}  // namespace oktett::rainbow_test
