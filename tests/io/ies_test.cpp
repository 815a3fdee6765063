#include "io/photometry/ies_file.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "core/error.h"
#include "core/random.h"
#include "tests/io/scene_test_support.h"

namespace oktett::ies_test {
namespace {

using test::SceneFiles;

/// The ten numbers that follow the tilt, and the three after them.
std::string numbers(int rows, int columns, int type = 1) {
  return "1 1000 2.5 " + std::to_string(rows) + " " + std::to_string(columns) + " " + std::to_string(type) +
         " 2 0.1 0.1 0\n1 1 60\n";
}

std::string head(const std::string& version) {
  return version + "[TEST] a lamp\n[MANUFAC] none, TILTED\nTILT=NONE\n";
}

class IesFile : public testing::Test {
 protected:
  LightProfile read(const std::string& text) const { return read_light_profile(dir_.write("a.ies", text)); }
  std::string error(const std::string& text) const {
    const std::string path = dir_.write("a.ies", text);
    try {
      read_light_profile(path);
    } catch (const Error& e) {
      return std::string(e.what()).substr(path.size() - 5);
    }
    return "no error";
  }
  test::TempDir dir_;
};

TEST_F(IesFile, ReadsAllVersionsOfTheFormat) {
  const std::string table = "0 45 90\n0\n10 20 5\n";
  for (const char* version : {"IESNA:LM-63-2002\n", "IESNA:LM-63-1995\r\n", "IESNA91\n", ""}) {
    const LightProfile p = read(head(version) + numbers(3, 1) + table);
    EXPECT_EQ(p.vertical, (std::vector<double>{0, 45, 90}));
    EXPECT_EQ(p.horizontal, (std::vector<double>{0}));
    EXPECT_EQ(p.values, (std::vector<float>{0.5f, 1, 0.25f}));
  }
  // Numbers may be broken into lines anywhere and have commas between them.
  const LightProfile p =
      read("TILT=INCLUDE\n1\n2\n0 90\n1 0.9\n1,1000,+2.5,3\n1,1,2,0.1,0.1,0\n1,1,60\n0,45\n90\n0\n10,2e1\n5");
  EXPECT_EQ(p.values, (std::vector<float>{0.5f, 1, 0.25f}));
  EXPECT_EQ(read("TILT= lamp.tlt\n" + numbers(3, 1) + table).values.size(), 3u);
}

// A table of f(v, h) with each of the symmetries is that of the full circle.
TEST_F(IesFile, SymmetriesAreFilledIn) {
  const auto expect_table = [&](double first, double last, double step, auto f) {
    std::string angles, values;
    int columns = 0;
    for (double h = first; h <= last; h += step, ++columns) {
      angles += std::to_string(h) + " ";
      for (const double v : {0.0, 60.0, 180.0}) values += std::to_string(f(v, h)) + " ";
      values += "\n";
    }
    const LightProfile p = read(head("") + numbers(3, columns) + "0 60 180\n" + angles + "\n" + values);
    ASSERT_EQ(p.horizontal.front(), 0);
    ASSERT_EQ(p.horizontal.back(), 360);
    const double greatest = profile_value(p, 60, 0) / f(60, 0);
    for (double h = 0; h <= 360; h += step)
      for (const double v : {0.0, 60.0, 180.0})
        EXPECT_NEAR(profile_value(p, v, h), f(v, h) * greatest, 1e-5)
            << first << ' ' << last << ' ' << v << ' ' << h;
  };
  const auto c = [](double h) { return std::cos(h * std::numbers::pi / 180); };
  const auto s = [](double h) { return std::sin(h * std::numbers::pi / 180); };
  expect_table(0, 90, 22.5, [&](double v, double h) { return 5 + v / 100 + c(h) * c(h); });
  expect_table(0, 180, 22.5, [&](double v, double h) { return 5 + v / 100 + 3 * c(h); });
  expect_table(90, 270, 22.5, [&](double v, double h) { return 5 + v / 100 + 3 * s(h); });
  expect_table(0, 360, 22.5, [&](double v, double h) { return 5 + v / 100 + 3 * c(h) + s(h); });
  // The last column may be left out.
  expect_table(0, 337.5, 22.5, [&](double v, double h) { return 5 + v / 100 + 3 * c(h) + s(h); });
}

TEST_F(IesFile, ErrorsNameLineAndColumn) {
  const std::string good = "TILT=NONE\n" + numbers(2, 1);
  const std::pair<std::string, std::string> cases[] = {
      {"", "a.ies:1:1: expected a line 'TILT=...', found the end of the file"},
      {"IESNA91\n[TEST]\n", "a.ies:2:1: expected a line 'TILT=...', found the end of the file"},
      {"TILT=\n", "a.ies:1:1: expected TILT=NONE"},
      {"TILT=INCLUDE\n4\n", "a.ies:2:1: expected the lamp's geometry"},
      {"TILT=INCLUDE\n1 1e9\n", "a.ies:2:3: expected the number of angles of tilt"},
      {"TILT=NONE\n1 x", "a.ies:2:3: expected the lumens of a lamp, found 'x'"},
      {"TILT=NONE\n1 1000 0", "a.ies:2:8: expected the factor on candela"},
      {"TILT=NONE\n1 1000 1 2.5", "a.ies:2:10: expected the number of vertical angles"},
      {"TILT=NONE\n1 1000 1 2 0", "a.ies:2:12: expected the number of horizontal angles"},
      {"TILT=NONE\n" + numbers(2, 1, 2), "a.ies:2:16: expected the photometric type 1 (C)"},
      {"TILT=NONE\n1 1000 1 2 1 1 3", "a.ies:2:16: expected the units"},
      {"TILT=NONE\n" + numbers(1, 1), "a.ies:3:5: expected at least 2 vertical angles"},
      {"TILT=NONE\n" + numbers(1000, 1000), "a.ies:3:5: the file is cut short"},
      {good + "0 181\n0\n1 1", "a.ies:4:3: expected a vertical angle from 0 to 180"},
      {good + "90 0\n0\n1 1", "a.ies:4:4: a vertical angle from 0 to 180 must be greater"},
      {good + "0 90\n0\n1 -1", "a.ies:6:3: expected an intensity from 0 to 1e30"},
      {good + "0 90\n0\n1 nan", "a.ies:6:3: expected an intensity from 0 to 1e30, found 'nan'"},
      {good + "0 90\n0\n1 inf", "a.ies:6:3: expected an intensity from 0 to 1e30, found 'inf'"},
      {good + "0 90\n0\n1 1e300", "a.ies:6:3: expected an intensity from 0 to 1e30"},
      {good + "0 90\n0\n0 0", "a.ies:6:3: all intensities are 0"},
      {good + "0 90\n0\n1\n", "a.ies:7:1: expected an intensity from 0 to 1e30, found the end"},
      {"TILT=NONE\n" + numbers(2, 2) + "0 90\n0 45\n1 1 1 1", "a.ies:5:3: expected horizontal angles from 0"},
      {"TILT=NONE\n" + numbers(2, 2) + "0 90\n90 180\n1 1 1 1",
       "a.ies:5:4: expected horizontal angles from 0"},
      {"TILT=NONE\n" + numbers(2, 2) + "0 90\n90 270\n1 1 1 1",
       "a.ies:5:4: expected horizontal angles from 0"}};
  for (const auto& [text, want] : cases) test::expect_starts(error(text), want);
}

// Whatever the bytes, it is an Error or a profile within its bounds.
TEST_F(IesFile, DamagedFilesAreHarmless) {
  const std::string good = head("IESNA91\n") + numbers(3, 3) + "0 45 90\n0 45 90\n1 2 3\n4 5 6\n7 8 9\n";
  for (std::uint32_t i = 0; i < 500; ++i) {
    std::string bad = good;
    const std::uint64_t bits = random_bits(5, i, 0);
    bad[bits % bad.size()] = static_cast<char>(bits >> 32);
    bad[(bits >> 16) % bad.size()] = "0.9-e \n,"[bits >> 61];
    if (i % 3 == 0) bad.resize((bits >> 24) % bad.size());
    try {
      const LightProfile p = read(bad);
      ASSERT_EQ(p.values.size(), p.vertical.size() * p.horizontal.size());
      for (const float v : p.values) ASSERT_TRUE(v >= 0 && v <= 1);
      ASSERT_TRUE(std::isfinite(profile_flux(p)));
    } catch (const Error&) {}
  }
}

TEST(SceneLightProfile, IsReadForPointsAndSpots) {
  const SceneFiles files;
  files.dir.write("a.ies", "TILT=NONE\n" + numbers(2, 1) + "0 180\n0\n7 7\n");
  const Scene scene = files.load_v1(
      "lights:\n"
      "  - point: {position: [0, 1, 0], profile: a.ies, power: [8, 8, 8], rotate: 20}\n"
      "  - spot: {position: [0, 1, 0], profile: a.ies, intensity: [3, 3, 3]}\n"
      "  - point: {position: [0, 1, 0], power: [8, 8, 8]}\n");
  const auto& point = std::get<PointLight>(scene.lights[0]);
  ASSERT_NE(point.profile, nullptr);
  EXPECT_TRUE(point.falloff);
  EXPECT_EQ(point.rotation, 20);
  EXPECT_NEAR(point.color.x, 8 / (4 * std::numbers::pi * std::numbers::pi), 1e-6);
  EXPECT_NEAR(std::get<SpotLight>(scene.lights[1]).color.x, 3 / std::numbers::pi, 1e-6);
  EXPECT_NEAR(std::get<PointLight>(scene.lights[2]).color.x, 8 / (4 * std::numbers::pi * std::numbers::pi),
              1e-6);
  const std::pair<const char*, const char*> cases[] = {
      {"lights: [{point: {position: [0, 1, 0], rotate: 3}}]", "scene.yaml:2:48: 'rotate' turns a 'profile'"},
      {"lights: [{point: {position: [0, 1, 0], power: [1, 1, 1], color: [1, 1, 1]}}]",
       "scene.yaml:2:18: expected 'color', 'intensity' or 'power', not two"},
      {"lights: [{spot: {position: [0, 1, 0], profile: a.ies, outer_angle: 3}}]",
       "scene.yaml:2:17: expected 'profile' or angles, not both"},
      {"lights: [{point: {position: [0, 1, 0], profile: b.ies}}]", "scene.yaml:2:49: "}};
  for (const auto& [text, want] : cases) test::expect_starts(files.error_v1(text), want);
}

}  // namespace
}  // namespace oktett::ies_test
