#include <gtest/gtest.h>

#include "io/scene/write_scene.h"
#include "tests/io/scene_test_support.h"

namespace oktett::scene_functions_test {
namespace {

using test::expect_starts;
using test::SceneFiles;
using test::shape_of;

const std::string kBounds = "bounds: {min: [-1, -2, -3], max: [1, 2, 3]}";

TEST(SceneFunctions, ReadsEveryParameter) {
  const Scene scene =
      SceneFiles().load_v1("objects:\n  - implicit: {function: \"x^2 + sin(y)*z\", " + kBounds +
                           ", open: true, normals: central}\n  - implicit: {function: x, " + kBounds + "}\n");
  EXPECT_TRUE(scene.warnings.empty());
  const auto& first = shape_of<ExactShape>(scene, 0);
  const auto& implicit = std::get<ImplicitShape>(first.form);
  EXPECT_EQ(first.normals, NormalMethod::central);
  EXPECT_TRUE(implicit.open);
  EXPECT_EQ(implicit.lo, (Vec3d{-1, -2, -3}));
  EXPECT_EQ(implicit.hi, (Vec3d{1, 2, 3}));
  EXPECT_EQ(implicit.function.steps.size(), 4u);
  const auto& second = shape_of<ExactShape>(scene, 1);
  EXPECT_EQ(second.normals, NormalMethod::gradient);
  EXPECT_FALSE(std::get<ImplicitShape>(second.form).open);
}

std::string repeat(const std::string& part, int n) {
  std::string all;
  for (int i = 0; i < n; ++i) all += part;
  return all;
}

/// Every error names line and column, and shows the place in the text by a caret.
TEST(SceneFunctions, ErrorsHaveTheirPlace) {
  const struct {
    std::string function, error;
  } kCases[] = {
      {"", "scene.yaml:2:34: bad function: expected a number, a name or '(' (column 1)\n  \n  ^"},
      {"x + ", "scene.yaml:2:38: bad function: expected a number, a name or '(' (column 5)\n  x + \n      ^"},
      {"x y", "scene.yaml:2:36: bad function: expected an operator or the end (column 3)\n  x y\n    ^"},
      {"x + w", "scene.yaml:2:38: bad function: unknown name 'w'"},
      {"x + sine(y)",
       "scene.yaml:2:38: bad function: unknown name 'sine'; did you mean 'sin'? (column 5)\n"
       "  x + sine(y)\n      ^"},
      {"(x + (y - z)",
       "scene.yaml:2:46: bad function: expected ')' for the '(' at column 1 (column 13)\n"
       "  (x + (y - z)\n              ^"},
      {"x)", "scene.yaml:2:35: bad function: ')' without '(' (column 2)\n  x)\n   ^"},
      {"atan2(x)", "scene.yaml:2:41: bad function: atan2 takes 2 arguments"},
      {"x + sqrt(-1)",
       "scene.yaml:2:38: bad function: the value is not a finite number (column 5)\n"
       "  x + sqrt(-1)\n      ^"},
      {"x/0", "scene.yaml:2:35: bad function: division by zero (column 2)\n  x/0\n   ^"},
      {"(-2)^x", "scene.yaml:2:38: bad function: only a positive number may have an exponent with x, y or z"},
      {repeat("(", 201) + "x" + repeat(")", 201), "scene.yaml:2:234: bad function: nested deeper than 200"},
      {repeat("sin(", 300) + "x" + repeat(")", 300), "scene.yaml:2:"},
  };
  SceneFiles files;
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.function.substr(0, 40));
    const std::string message =
        files.error_v1("objects: [{implicit: {function: \"" + c.function + "\", " + kBounds + "}}]");
    expect_starts(message, c.error);
    EXPECT_NE(message.find("^"), std::string::npos) << message;
  }
  expect_starts(
      files.error_v1("objects: [{implicit: {function: \"x" + repeat(" + 1", 5000) + "\", " + kBounds + "}}]"),
      "scene.yaml:2:33: the value is too long");
  std::string many = "x";
  for (int i = 0; i < 1100; ++i) many += "+sin(" + std::to_string(i) + "*x)";
  EXPECT_NE(files.error_v1("objects: [{implicit: {function: \"" + many + "\", " + kBounds + "}}]")
                .find("the function takes more than 1024 steps"),
            std::string::npos);
}

TEST(SceneFunctions, WhatIsMissingOrWrong) {
  const struct {
    std::string object, error;
  } kCases[] = {
      {"implicit: {function: x}", "scene.yaml:2:22: implicit needs 'bounds'"},
      {"implicit: {" + kBounds + "}", "scene.yaml:2:22: implicit needs 'function'"},
      {"implicit: {function: x, bounds: {min: [0, 0, 0]}}", "scene.yaml:2:44: bounds needs 'max'"},
      {"implicit: {function: x, bounds: {min: [0, 0, 0], max: [1, 1, 0]}}",
       "scene.yaml:2:66: the z of max must be greater than that of min"},
      {"implicit: {function: x, bounds: {min: [0, 0, 0], max: [1, .inf, 1]}}", "scene.yaml:2:"},
      {"implicit: {function: [x], " + kBounds + "}", "scene.yaml:2:"},
      {"implicit: {function: x, iso: 1, " + kBounds + "}", "scene.yaml:2:"},
      {"implicit: {function: x, open: perhaps, " + kBounds + "}", "scene.yaml:2:"},
      {"implicit: {function: x, normals: guessed, " + kBounds + "}", "scene.yaml:2:"},
  };
  SceneFiles files;
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.object);
    expect_starts(files.error_v1("objects: [{" + c.object + "}]"), c.error);
  }
}

/// A function is written out and read again: the values are the same.
TEST(SceneFunctions, NoiseIsWrittenAsItWasRead) {
  const SceneFiles files;
  const Scene scene = files.load_v1("objects: [{implicit: {function: \"y - noise(2*x, x*z, z + 1)*0.25\", " +
                                    kBounds + "}}]");
  const std::string path = (files.dir.path() / "again.yaml").string();
  write_scene_file(path, scene);
  const Scene again = load_scene_file(path);
  const auto& first = std::get<ImplicitShape>(shape_of<ExactShape>(scene, 0).form).function;
  const auto& second = std::get<ImplicitShape>(shape_of<ExactShape>(again, 0).form).function;
  for (const double x : {0.3, -0.7, 0.9})
    EXPECT_EQ(value_at(first, x, 0.25, 1 - x), value_at(second, x, 0.25, 1 - x));
}

TEST(SceneFunctions, ConstantsAreSkipped) {
  const Scene scene =
      SceneFiles().load_v1("objects: [{implicit: {function: \"2*pi - 7\", " + kBounds + "}}]");
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(std::string(scene.warnings[0].message).find("does not depend on x, y or z"), std::string::npos);
}

}  // namespace
}  // namespace oktett::scene_functions_test
