#include <gtest/gtest.h>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_prism_test {
namespace {

using test::expect_starts;
using test::SceneFiles;

const PrismShape& prism(const Scene& scene, std::size_t i) {
  return std::get<PrismShape>(test::shape_of<ExactShape>(scene, i).form);
}

TEST(ScenePrism, ReadsOutlines) {
  const Scene scene = SceneFiles().load_v1(
      "objects:\n"
      "  - prism: {outlines: [[[0, 0], [1, 0], [0, 1]], [[5, 5], [6, 5], [5, 6], [5, 5]]]}\n"
      "  - prism: {curve: cubic, sweep: conic, from: -2, to: 3, open: true, outlines: [[[0, 1], [0, 0], [1, "
      "0], "
      "[0, 1], [0, 0], [1, 0]]]}\n");
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(prism(scene, 0).outlines.size(), 2u);
  EXPECT_EQ(prism(scene, 0).outlines[1].size(), 4u);
  EXPECT_EQ(prism(scene, 0).outlines[1][2], (FlatPoint{5, 6}));
  EXPECT_EQ(prism(scene, 0).to, 1);
  EXPECT_EQ(prism(scene, 1).curve, PrismShape::Curve::cubic);
  EXPECT_EQ(prism(scene, 1).sweep, PrismShape::Sweep::conic);
  EXPECT_EQ(prism(scene, 1).from, -2);
  EXPECT_TRUE(prism(scene, 1).open);
}

TEST(ScenePrism, ErrorsHaveTheirPlace) {
  const struct {
    const char *object, *error;
  } kCases[] = {
      {"prism: {outlines: []}", "scene.yaml:2:30: expected 1 to"},
      {"prism: {outlines: [[[0, 0], [1, 1]]]}", "scene.yaml:2:31: expected at least 3 points, found 2"},
      {"prism: {outlines: [[[0, 0], [1, 1], [2]]]}", "scene.yaml:2:48"},
      {"prism: {curve: bezier, outlines: [[[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]]}",
       "scene.yaml:2:46: expected 4, 7, 10, … points, 3 more for each piece; found 5"},
      {"prism: {curve: cubic, outlines: [[[0, 0], [1, 0], [1, 1]]]}",
       "scene.yaml:2:45: expected at least 4 points, found 3"},
      {"prism: {curve: round, outlines: [[[0, 0], [1, 0], [1, 1]]]}",
       "scene.yaml:2:27: expected linear or quadratic or cubic"},
  };
  SceneFiles files;
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.object);
    expect_starts(files.error_v1("objects: [{" + std::string(c.object) + "}]"), c.error);
  }
}

TEST(ScenePrism, ReadsSweepsAndHoles) {
  const Scene scene = SceneFiles().load_v1(
      "objects:\n"
      "  - sphere_sweep: {curve: b_spline, spheres: [[0, 0, 0, 1], [1, 0, 0, 2], [2, 0, 0, 1], [3, 0, 0, "
      "0]]}\n"
      "  - disk: {radius: 2, inner_radius: 1}\n"
      "  - polygon: {vertices: [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]],\n"
      "              holes: [[[1, 1, 0], [2, 1, 0], [1, 2, 0]], [[3, 3, 0], [3, 2, 0], [2, 3, 0]]]}\n");
  EXPECT_TRUE(scene.warnings.empty());
  const auto& sweep = std::get<SphereSweepShape>(test::shape_of<ExactShape>(scene, 0).form);
  EXPECT_EQ(sweep.curve, SphereSweepShape::Curve::b_spline);
  ASSERT_EQ(sweep.spheres.size(), 4u);
  EXPECT_EQ(sweep.spheres[1].center, (Vec3d{1, 0, 0}));
  EXPECT_EQ(sweep.spheres[1].radius, 2);
  EXPECT_EQ(test::shape_of<DiskShape>(scene, 1).inner_radius, 1);
  const auto& polygon = test::shape_of<PolygonShape>(scene, 2);
  ASSERT_EQ(polygon.holes.size(), 2u);
  EXPECT_EQ(polygon.holes[1].vertices[1], (Vec3d{3, 2, 0}));
}

TEST(ScenePrism, ErrorsOfSweepsAndHoles) {
  const struct {
    const char *object, *error;
  } kCases[] = {
      {"sphere_sweep: {spheres: [[0, 0, 0, 1]]}", "scene.yaml:2:36: expected 2 to"},
      {"sphere_sweep: {curve: cubic, spheres: [[0, 0, 0, 1], [1, 0, 0, 1]]}",
       "scene.yaml:2:50: expected at least 4"},
      {"sphere_sweep: {spheres: [[0, 0, 0, 1], [1, 0, 0, -1]]}", "scene.yaml:2:51: the radius of a sphere"},
      {"disk: {radius: 1, inner_radius: 1}", "scene.yaml:2:44: the hole must be smaller than the disk"},
  };
  SceneFiles files;
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.object);
    expect_starts(files.error_v1("objects: [{" + std::string(c.object) + "}]"), c.error);
  }
  for (const char* holes : {"[[[1, 1, 0], [2, 1, 0], [5, 2, 0]]]", "[[[1, 1, 1], [2, 1, 0], [1, 2, 0]]]"}) {
    const Scene scene =
        files.load_v1("objects: [{polygon: {vertices: [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], holes: " +
                      std::string(holes) + "}}]");
    EXPECT_EQ(scene.warnings.size(), 1u) << holes;
  }
}

TEST(ScenePrism, EmptyOnesAreSkipped) {
  for (const char* prism :
       {"{outlines: [[[0, 0], [1, 0], [2, 0]]]}", "{from: 1, to: 1, outlines: [[[0, 0], [1, 0], [2, 2]]]}"}) {
    const Scene scene = SceneFiles().load_v1(std::string("objects:\n  - prism: ") + prism + "\n");
    EXPECT_EQ(scene.warnings.size(), 1u) << prism;
    EXPECT_TRUE(scene.objects.empty());
  }
}

}  // namespace
}  // namespace oktett::scene_prism_test
