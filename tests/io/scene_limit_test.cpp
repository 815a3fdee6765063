// Files that ask for too much end in an error, soon and with little memory.

#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_limit_test {
namespace {

using test::expect_starts;
using test::SceneFiles;

std::string repeat(const std::string& part, int n) {
  std::string all;
  for (int i = 0; i < n; ++i) all += part;
  return all;
}

TEST(SceneLimit, Nesting) {
  SceneFiles files;
  for (const char* part : {"[", "{a: ", "[{a: ", "- ", "? ", "- ? ", "{? ", "[[],", "{a: {}, b: "}) {
    SCOPED_TRACE(part);
    const std::string message = files.error(repeat(part, 200000));
    EXPECT_TRUE(message.find("nested deeper than 100 levels") != std::string::npos ||
                message.find("not valid YAML") != std::string::npos ||
                message.find("expected a name") != std::string::npos)
        << message;
  }
  std::string indents = "oktett: 1\nobjects:\n";
  for (int i = 0; i < 300; ++i) indents += std::string(static_cast<std::size_t>(2 * i), ' ') + "- group:\n";
  expect_starts(files.error(indents), "scene.yaml:52:101: nested deeper than 100 levels");
  expect_starts(files.error_v1("objects: " + repeat("[", 99) + repeat("]", 99)),
                "scene.yaml:2:11: expected a map");
  expect_starts(files.error_v1("objects: " + repeat("[", 100) + repeat("]", 100)),
                "scene.yaml:2:109: nested deeper");
}

TEST(SceneLimit, NestingThroughAliases) {
  std::string text = "params: &p0 {}\n";
  for (int i = 1; i < 50; ++i)
    text += "k" + std::to_string(i) + ": &p" + std::to_string(i) + " [[[*p" + std::to_string(i - 1) + "]]]\n";
  expect_starts(SceneFiles().error_v1(text), "scene.yaml:35:14: nested deeper than 100 levels");
}

TEST(SceneLimit, AliasBombs) {
  std::string text = "params: &p0 [1, 2, 3, 4, 5, 6, 7, 8]\n";
  for (int i = 1; i < 40; ++i) {
    const std::string alias = "*p" + std::to_string(i - 1);
    text +=
        "k" + std::to_string(i) + ": &p" + std::to_string(i) + " [" + repeat(alias + ", ", 7) + alias + "]\n";
  }
  const std::string message = SceneFiles().error_v1(text);
  EXPECT_NE(message.find("the scene has more than 1000000 values, aliases expanded"), std::string::npos)
      << message;
  EXPECT_NE(SceneFiles().error_v1("objects: &a [*a]").find("the alias stands inside what it names"),
            std::string::npos);
}

TEST(SceneLimit, ParameterBombs) {
  std::string text = "params:\n  p0: aaaaaaaaaa\n";
  for (int i = 1; i < 40; ++i)
    text += "  p" + std::to_string(i) + ": \"" + repeat("${p" + std::to_string(i - 1) + "}", 10) + "\"\n";
  expect_starts(SceneFiles().error_v1(text), "scene.yaml:7:7: the value is too long");
  std::string many = "params:\n";
  for (int i = 0; i <= 1000; ++i) many += "  p" + std::to_string(i) + ": 1\n";
  expect_starts(SceneFiles().error_v1(many), "scene.yaml:1003:3: more than 1000 parameters");
}

TEST(SceneLimit, Includes) {
  SceneFiles files;
  for (int i = 0; i < 20; ++i)
    files.dir.write("f" + std::to_string(i) + ".yaml",
                    "oktett: 1\ninclude: [f" + std::to_string(i + 1) + ".yaml]\n");
  EXPECT_EQ(files.error_v1("include: [f0.yaml]"),
            "f15.yaml:2:11: included files are nested deeper than 16 levels");
  // Each file twice: 2^15 readings if a file were merged as often as it is named.
  for (int i = 0; i < 15; ++i) {
    const std::string next = "g" + std::to_string(i + 1) + ".yaml";
    files.dir.write("g" + std::to_string(i) + ".yaml", "oktett: 1\ninclude: [" + next + ", " + next + "]\n");
  }
  files.dir.write("g15.yaml", "oktett: 1\nobjects: [{sphere: {}}]\n");
  EXPECT_EQ(files.load_v1("include: [g0.yaml]").objects.size(), 1u);
}

TEST(SceneLimit, FileSize) {
  SceneFiles files;
  EXPECT_EQ(files.error("oktett: 1\n#" + std::string(std::size_t{17} << 20, 'x')),
            "scene.yaml: the file is larger than 16 MiB");
  // A long key and a long list are refused before they take long, and so is what several files hold together.
  expect_starts(files.error("oktett: 1\n? " + std::string(20'000'000, 'k') + "\n: 1\n"),
                "scene.yaml: the file is larger than 16 MiB");
  expect_starts(files.error_v1("objects: [" + repeat("1,", 1'000'000) + "1]\n"),
                "scene.yaml:2:2000001: the scene has more than 1000000 values");
  std::string includes = "include: [";
  for (int i = 0; i < 4; ++i) {
    files.dir.write("h" + std::to_string(i) + ".yaml",
                    "oktett: 1\n#" + std::string(std::size_t{5} << 20, 'x') + "\n");
    includes += "h" + std::to_string(i) + ".yaml, ";
  }
  expect_starts(files.error_v1(includes + "]\n"),
                "h3.yaml: the scene and the files that it includes are larger than 16 MiB in all");
}

TEST(SceneLimit, PolygonVertices) {
  const std::string text = "objects: [{polygon: {vertices: [" + repeat("[0, 0, 0], ", 5000) + "[1, 1, 1]]}}]";
  expect_starts(SceneFiles().error_v1(text), "scene.yaml:2:32: expected 3 to 4096 vertices, found 5001");
}

/// Long lines, long names and many keys take less than quadratic time.
TEST(SceneLimit, LongFilesLoadInTime) {
  const auto start = std::chrono::steady_clock::now();
  SceneFiles files;
  std::string materials = "materials: {";
  for (int i = 0; i < 50000; ++i) materials += "m" + std::to_string(i) + ": {}, ";
  EXPECT_EQ(files.load_v1(materials + "\xc3\xa9: {}}\n").materials.size(), 50001u);
  EXPECT_NE(files.error_v1(materials + "\xc3\xa9: {}}\nobjects: [{sphere: {}, material: m}]")
                .find("unknown material"),
            std::string::npos);
  EXPECT_EQ(files.load_v1("objects: [" + repeat("{sphere: {}}, ", 50000) + "{box: {}}]\n").objects.size(),
            50001u);
  expect_starts(files.error_v1(std::string(1000000, 'k') + ": 1\n"),
                "scene.yaml:2:1000001: not valid YAML: ");
  expect_starts(files.error_v1("objects: [{sphere: {}, material: " + std::string(1000000, 'k') + "}]\n"),
                "scene.yaml:2:34: the value is too long");
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  EXPECT_LT(elapsed.count(), 60);
}

}  // namespace
}  // namespace oktett::scene_limit_test
