#include <gtest/gtest.h>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_polynomial_test {
namespace {

using test::expect_starts;
using test::SceneFiles;
using test::shape_of;

template <class T>
const T& form_of(const Scene& scene, std::size_t i = 0) {
  return std::get<T>(shape_of<ExactShape>(scene, i).form);
}

const char* const kBounds = "bounds: {min: [-1, -2, -3], max: [1, 2, 3]}";

TEST(ScenePolynomial, ReadsEveryParameter) {
  const Scene scene = SceneFiles().load_v1(
      "objects:\n"
      "  - polynomial: {equation: \"x^4 + y^4 = 1 - z^4\", " +
      std::string(kBounds) +
      ", open: true, root_finder: sturm}\n"
      "  - blob: {sources: [{point: [1, 2, 3], weight: 2}, {line: {point: [4, 5, 6], direction: [0, 0, "
      "2]}},\n"
      "           {plane: {normal: [0, 3, 0], offset: 4}, weight: -1}], iso: 5, " +
      kBounds +
      ", open: true}\n"
      "  - revolution: {points: [[1, 0], [2, 1], [1, 2], [0, 3]], open: true}\n"
      "  - revolution: {points: [[1, 0], [2, 1], [0, 1]], profile: linear}\n"
      "  - revolution: {points: [[1, 0], [2, 1], [1, 2], [0, 3]], profile: sor}\n"
      "  - revolution: {points: [[1, 0], [2, 0], [2, 1], [1, 1]], profile: bezier, open: true}\n"
      "  - revolution: {points: [[1, 0], [2, 1], [1, 2], [0, 1]], profile: curve}\n");
  EXPECT_TRUE(scene.warnings.empty());
  const auto& p = form_of<PolynomialShape>(scene, 0);
  EXPECT_EQ(p.terms.size(), 4u);
  EXPECT_EQ(p.hi, (Vec3d{1, 2, 3}));
  EXPECT_TRUE(p.open);
  EXPECT_EQ(p.root_finder, roots::Method::sturm);
  const auto& b = form_of<BlobShape>(scene, 1);
  ASSERT_EQ(b.sources.size(), 3u);
  EXPECT_EQ(b.sources[0].at, (Vec3d{1, 2, 3}));
  EXPECT_EQ(b.sources[0].weight, 2);
  EXPECT_EQ(b.sources[1].kind, BlobSource::Kind::line);
  EXPECT_EQ(b.sources[1].direction, (Vec3d{0, 0, 2}));
  EXPECT_EQ(b.sources[2].kind, BlobSource::Kind::plane);
  EXPECT_EQ(b.sources[2].offset, 4);
  EXPECT_EQ(b.iso, 5);
  EXPECT_TRUE(b.bounded && b.open);
  EXPECT_TRUE(form_of<RevolutionShape>(scene, 2).open);
  EXPECT_EQ(form_of<RevolutionShape>(scene, 3).profile, RevolutionShape::Profile::linear);
  EXPECT_EQ(form_of<RevolutionShape>(scene, 4).profile, RevolutionShape::Profile::sor);
  EXPECT_EQ(form_of<LatheShape>(scene, 5).points.size(), 4u);
  EXPECT_EQ(form_of<LatheShape>(scene, 6).points.front().radius, 2);
  EXPECT_EQ(form_of<LatheShape>(scene, 6).points.back().height, 2);
}

TEST(ScenePolynomial, ErrorsHaveTheirPlace) {
  const struct {
    std::string object, error;
  } kCases[] = {
      {"polynomial: {equation: \"x^2 + 1/y\", " + std::string(kBounds) + "}",
       "scene.yaml:2:43: bad equation: not a polynomial: the divisor has x, y or z in it (column 8)\n"
       "  x^2 + 1/y\n         ^"},
      {"polynomial: {equation: \"x^2 = sin(x)\", " + std::string(kBounds) + "}",
       "scene.yaml:2:42: bad equation: not a polynomial: a function of x, y or z (column 7)"},
      {"polynomial: {equation: \"x^40\", " + std::string(kBounds) + "}",
       "scene.yaml:2:37: bad equation: the degree is above 32 (column 2)"},
      {"polynomial: {equation: \"x\"}", "scene.yaml:2:24: polynomial needs 'bounds'"},
      {"polynomial: {" + std::string(kBounds) + "}", "scene.yaml:2:24: polynomial needs 'equation'"},
      {"polynomial: {equation: x, bounds: {min: [0, 0, 0], max: [1, 0, 1]}}",
       "scene.yaml:2:68: the y of max must be greater than that of min"},
      {"polynomial: {equation: x, root_finder: sturn, " + std::string(kBounds) + "}", "scene.yaml:2:"},
      {"blob: {sources: []}", "scene.yaml:2:28: expected 1 to 16 sources, found 0"},
      {"blob: {sources: [{point: [0, 0, 0], line: {}}]}", "scene.yaml:2:29: a source is one of"},
      {"blob: {sources: [{line: {direction: [0, 0, 0]}}]}",
       "scene.yaml:2:48: the direction must not be zero"},
      {"blob: {sources: [{plane: {normal: [0, 1, 0]}}]}", "scene.yaml:2:18: a blob with lines or planes"},
      {"blob: {sources: [{point: [0, 0, 0]}], iso: 0}", "scene.yaml:2:55: expected a number greater than 0"},
      {"revolution: {points: [[1, 0], [1, 1], [1, 2]]}",
       "scene.yaml:2:33: expected 4 to 1024 points, found 3"},
      {"revolution: {points: [[1, 0], [1, 2], [1, 2], [1, 3]]}", "scene.yaml:2:50: heights must ascend"},
      {"revolution: {points: [[1, 0], [-1, 1], [1, 2], [1, 3]]}",
       "scene.yaml:2:42: the profile crosses the axis"},
      {"revolution: {points: [[9, 0], [0.1, 1], [0.1, 2], [9, 3]]}",
       "scene.yaml:2:33: the profile crosses the axis: at"},
      {"revolution: {profile: bezier, points: [[1, 0], [-3, 1], [-3, 2], [1, 3]]}",
       "scene.yaml:2:50: the profile crosses the axis"},
      {"revolution: {profile: bezier, points: [[1, 0], [5, 3], [5, -2], [1, 1]]}",
       "scene.yaml:2:50: the profile crosses itself"},
      {"revolution: {profile: bezier, points: [[1, 0], [9, 1], [0, 1], [3, 0]]}",
       "scene.yaml:2:50: the profile crosses itself"},
      {"revolution: {profile: bezier, points: [[1, 0], [9, 4], [0, 4], [4, 0], [4, 0], [4, 2], [1, 2]]}",
       "scene.yaml:2:50: the profile crosses itself"},
      {"revolution: {profile: bezier, points: [[1, 0], [1, 1], [1, 2], [1, 3], [1, 4]]}",
       "scene.yaml:2:50: expected 4, 7, 10"},
      {"revolution: {profile: round, points: []}", "scene.yaml:2:34: expected spline or linear or sor"},
  };
  SceneFiles files;
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.object);
    expect_starts(files.error_v1("objects: [{" + c.object + "}]"), c.error);
  }
}

/// A shape without any surface is skipped with a warning.
TEST(ScenePolynomial, DegenerateOnesAreSkipped) {
  const struct {
    std::string object, warning;
  } kCases[] = {
      {"polynomial: {equation: \"1 = 2\", " + std::string(kBounds) + "}", "does not depend on x, y or z"},
      {"polynomial: {equation: \"x = x\", " + std::string(kBounds) + "}", "does not depend on x, y or z"},
      {"blob: {sources: [{point: [0, 0, 0], weight: -1}]}", "no source has a positive weight"},
      {"revolution: {points: [[1, 0], [0, 1], [0, 2], [1, 3]]}", "all radii are zero"},
      {"revolution: {points: [[1, 0], [2, 0]], profile: linear}", "all heights are the same"},
  };
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.object);
    const Scene scene = SceneFiles().load_v1("objects: [{" + c.object + "}]");
    EXPECT_TRUE(scene.objects.empty());
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].message.find(c.warning), std::string::npos) << scene.warnings[0].message;
    EXPECT_GT(scene.warnings[0].where.line, 0);
  }
}

}  // namespace
}  // namespace oktett::scene_polynomial_test
