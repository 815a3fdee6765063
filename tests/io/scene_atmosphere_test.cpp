/// \file Fog with swaths, rainbows and materials with another back in scene files, and what is wrong with
/// them.

#include <gtest/gtest.h>

#include <string>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_atmosphere_test {
namespace {

using test::SceneFiles;

TEST(SceneAtmosphere, RainbowsAreRead) {
  const SceneFiles files;
  const Scene scene = files.load_v1(
      "rainbow: [{direction: [0, -1, -2], angle: 40, width: 2, distance: 5, up: [1, 0, 0], arc: 90, "
      "falloff_arc: "
      "60, colors: [{at: 0, color: [1, 0, 0], transmit: 0.5}, {at: 1, color: [0, 0, 1], filter: 0.25}]}]");
  Rainbow expected;
  expected.direction = {0, -1, -2}, expected.angle = 40, expected.width = 2, expected.distance = 5;
  expected.up = {1, 0, 0}, expected.arc = 90, expected.falloff_arc = 60;
  expected.colors = {{0, {1, 0, 0}, 0.5, 0}, {1, {0, 0, 1}, 0, 0.25}};
  ASSERT_EQ(scene.rainbows.size(), 1u);
  EXPECT_EQ(scene.rainbows[0], expected);
  const auto error = [&](const std::string& keys) {
    return files.error_v1("rainbow: [{distance: 1, " + keys + "}]");
  };
  const auto expect = [&](const std::string& keys, const std::string& part) {
    EXPECT_NE(error(keys).find(part), std::string::npos) << error(keys);
  };
  expect("angle: 1", "a rainbow needs 'colors'");
  expect("colors: []", "expected at least one colour");
  expect("colors: [{at: 1, color: [0, 0, 0]}, {at: 0, color: [0, 0, 0]}]",
         "the places of colours must ascend");
  expect("colors: [{at: 0, color: [0, 0, 0]}], direction: [0, 0, 0]", "the direction must not be zero");
  expect("colors: [{at: 2, color: [0, 0, 0]}]", "expected a number from 0 to 1, found '2'");
}

TEST(SceneAtmosphere, FogMayHaveSwaths) {
  const SceneFiles files;
  const Scene scene = files.load_v1(
      "fog: [{distance: 5, color: [1, 1, 1], turbulence: [1, 2, 3], turbulence_depth: 0.25, octaves: 3, "
      "lambda: "
      "2.5, omega: 0.7}]");
  ASSERT_EQ(scene.fogs.size(), 1u);
  EXPECT_EQ(scene.fogs[0].turbulence, (Vec3d{1, 2, 3}));
  EXPECT_EQ(scene.fogs[0].turbulence_depth, 0.25);
  EXPECT_EQ(scene.fogs[0].clouds.octaves, 3u);
  EXPECT_EQ(scene.fogs[0].clouds.lambda, 2.5);
  EXPECT_EQ(scene.fogs[0].clouds.omega, 0.7);
}

TEST(SceneAtmosphere, BacksAreNamesOfMaterialsFurtherUp) {
  const SceneFiles files;
  const Scene scene = files.load_v1(
      "materials: {inner: {}, outer: {back: inner, reflection_color: [1, 0.5, 0], "
      "reflection: 0.5}}");
  EXPECT_EQ(scene.materials.at(1).back, 0u);
  EXPECT_EQ(scene.materials.at(0).back, kNoId);
  EXPECT_EQ(scene.materials.at(1).reflection_color, (Color{1, 0.5f, 0}));
  const auto expect = [&](const std::string& materials, const std::string& part) {
    const std::string error = files.error_v1("materials: {" + materials + "}");
    EXPECT_NE(error.find(part), std::string::npos) << error;
  };
  expect("a: {back: b}", "unknown material 'b'");
  expect("a: {back: a}", "material 'a' must stand before what it is the back of");
  expect("a: {}, b: {back: a}, c: {back: b}", "material 'b' has a back itself");
}

}  // namespace
}  // namespace oktett::scene_atmosphere_test
