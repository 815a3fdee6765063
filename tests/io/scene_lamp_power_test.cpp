/// \file The power of lamps that are as small or as large as they may be.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/picture/render.h"
#include "tests/io/scene_test_support.h"

namespace oktett::scene_lamp_power_test {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;

/// What a white floor below a lamp of `power` at distance `distance` shows in the middle of the picture.
double lit(const std::string& kind, const std::string& lamp, double power, double distance) {
  const std::string number = fmt::format("{:.17g}", power);
  Scene scene = SceneFiles().load_v1(fmt::format(
      "camera: {{from: [0, 0, 0.5], at: [0, 0, 0], up: [0, 1, 0], fov: 1}}\n"
      "film: {{width: 1, height: 1}}\n"
      "integrator: {{kind: {}, samples: 64, depth: 1{}}}\n"
      "objects:\n"
      "  - {{plane: {{normal: [0, 0, 1], offset: 0}}, material: {{color: [1, 1, 1], ambient: 0, diffuse: 1, "
      "specular: 0}}}}\n"
      "lights: [{{{}, power: [{}, {}, {}]}}}}]\n",
      kind, kind == "whitted" ? ", light_samples: 16" : "",
      fmt::format(fmt::runtime(lamp), fmt::format("[0, 0, {}]", distance)), number, number, number));
  return render(std::move(scene), {}).picture.find("R")->values[0];
}

// A sphere sends power / (4 pi) in all directions, a flat lamp power / pi straight down; a white floor shows
// 1 / pi of what falls on it.
TEST(SceneLampPower, TheSmallestAndTheLargestLightAsMuchAsOthers) {
  const struct {
    const char* lamp;
    double intensity;  ///< of power 1, straight down
  } kLamps[] = {{"sphere: {{center: {}, radius: 0.001", 1 / (4 * kPi)},
                {"sphere: {{center: {}, radius: 3e-15", 1 / (4 * kPi)},
                {"disk: {{center: {}, normal: [0, 0, -1], radius: 0.001", 1 / kPi},
                {"disk: {{center: {}, normal: [0, 0, -1], radius: 6e-15", 1 / kPi},
                {"rectangle: {{corner: {}, u: [0, 1.1e-14, 0], v: [1e-14, 0, 0]", 1 / kPi},
                {"rectangle: {{corner: {}, u: [0, 1e-3, 0], v: [1.1e-25, 0, 0]", 1 / kPi}};
  for (const std::string kind : {"path", "whitted"})
    for (const auto& [lamp, intensity] : kLamps)
      for (const double power : {1e-6, 1.0, 1e6})
        for (const double distance : {1.0, 100.0, 1e4}) {
          const double expected = power * intensity / (kPi * distance * distance);
          EXPECT_NEAR(lit(kind, lamp, power, distance) / expected, 1, 2e-3)
              << kind << ", " << lamp << ", " << power << " W at " << distance;
        }
}

std::string error_of(const std::string& lamp) { return SceneFiles().error_v1("lights:\n  - " + lamp + "\n"); }

TEST(SceneLampPower, LampsThatAreTooSmallAreRefused) {
  const std::string small = "the light is too small: its area is ";
  expect_starts(
      error_of("sphere: {center: [0, 0, 0], radius: 1e-20, power: [1, 1, 1]}"),
      "scene.yaml:3:55: " + small + "1.3e-39, and at least 1e-28 is expected with a power; a 'point'");
  for (const char* lamp :
       {"sphere: {center: [0, 0, 0], radius: 2.8e-15, power: [0, 1, 0]}",
        "sphere: {center: [0, 0, 0], radius: 1e-200, power: [0, 1, 0]}",
        "disk: {center: [0, 0, 0], radius: 5.6e-15, power: [0, 1, 0]}",
        "rectangle: {corner: [0, 0, 0], u: [1, 0, 0], v: [0, 9e-29, 0], power: [0, 0, 1]}"}) {
    const std::string error = error_of(lamp);
    EXPECT_NE(error.find(small), std::string::npos) << lamp << "\n" << error;
  }
  for (const char* lamp :
       {"sphere: {center: [0, 0, 0], radius: 2.9e-15, power: [0, 1, 0]}",
        "disk: {center: [0, 0, 0], radius: 5.7e-15, power: [0, 1, 0]}",
        "rectangle: {corner: [0, 0, 0], u: [1, 0, 0], v: [0, 1.1e-28, 0], power: [0, 0, 1]}",
        "sphere: {center: [0, 0, 0], radius: 1e-20, power: [0, 0, 0]}",
        "sphere: {center: [0, 0, 0], radius: 1e-20, radiance: [1, 1, 1]}"})
    EXPECT_EQ(error_of(lamp), "no error") << lamp;
}

// The radiance is a number of single precision, and no denormal one.
TEST(SceneLampPower, RadianceIsInRange) {
  const auto sphere = [](double radius, double power) {
    return error_of(
        fmt::format("sphere: {{center: [0, 0, 0], radius: {}, power: [0, {}, 0]}}", radius, power));
  };
  const double area = 4 * kPi * 1e-28, most = 3.4028e38 * kPi * area;
  EXPECT_EQ(sphere(1e-14, most), "no error");
  EXPECT_EQ(
      sphere(1e-14, 1.001 * most),
      "scene.yaml:3:55: a power of 1.34e+12 over an area of 1.26e-27 is a radiance of 3.406e+38; expected "
      "one from 1.175e-38 to 3.403e+38");
  const double least = 1.1755e-38 * kPi * 4 * kPi * 1e20;
  EXPECT_EQ(sphere(1e10, least), "no error");
  expect_starts(sphere(1e10, 0.999 * least), "scene.yaml:3:61: a power of 4.6");
  EXPECT_EQ(sphere(1e18, 1), "no error");
}

}  // namespace
}  // namespace oktett::scene_lamp_power_test
