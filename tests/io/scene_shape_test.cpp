#include <gtest/gtest.h>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_shape_test {
namespace {

using test::expect_errors;
using test::expect_skipped;
using test::expect_starts;
using test::SceneFiles;
using test::shape_of;

TEST(SceneShape, HasNaturalDefaults) {
  const Scene scene =
      SceneFiles().load_v1("objects: [{sphere: }, {plane: }, {disk: }, {box: }, {triangle: {}}]\n");
  EXPECT_EQ(shape_of<SphereShape>(scene, 0).radius, 1);
  EXPECT_EQ(shape_of<PlaneShape>(scene, 1).normal, (Vec3d{0, 1, 0}));
  EXPECT_EQ(shape_of<DiskShape>(scene, 2).radius, 1);
  EXPECT_EQ(shape_of<BoxShape>(scene, 3).max, (Vec3d{1, 1, 1}));
  EXPECT_EQ(shape_of<TriangleShape>(scene, 4).v[1], (Vec3d{1, 0, 0}));
}

TEST(SceneShape, ReadsEveryShape) {
  const Scene scene = SceneFiles().load_v1(
      "objects:\n"
      "  - triangle: {vertices: [[1, 2, 3], [4, 5, 6], [7, 8, 0]]}\n"
      "  - sphere: {center: [1, 2, 3], radius: 4}\n"
      "  - plane: {normal: [0, 0, 2], offset: -1}\n"
      "  - disk: {center: [1, 2, 3], normal: [1, 0, 0], radius: 2}\n"
      "  - box: {min: [0, 0, 0], max: [1, 2, 0]}\n"
      "  - polygon: {vertices: [[0, 0, 0], [2, 0, 0], [2, 0, 2], [1, 0, 1], [0, 0, 2], [0, 0, 0]]}\n"
      "  - spheres: [{center: [1, 2, 3]}, {radius: 2}]\n"
      "  - spheres: {centers: [[0, 0, 0], [1, 1, 1]], radius: 0.5}\n");
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.objects.size(), 8u);
  EXPECT_EQ(shape_of<TriangleShape>(scene, 0).v[2], (Vec3d{7, 8, 0}));
  EXPECT_EQ(shape_of<SphereShape>(scene, 1).center, (Vec3d{1, 2, 3}));
  EXPECT_EQ(shape_of<PlaneShape>(scene, 2).offset, -1);
  EXPECT_EQ(shape_of<DiskShape>(scene, 3).normal, (Vec3d{1, 0, 0}));
  EXPECT_EQ(shape_of<BoxShape>(scene, 4).max, (Vec3d{1, 2, 0}));
  EXPECT_EQ(shape_of<PolygonShape>(scene, 5).vertices.size(), 5u) << "the last vertex repeats the first";
  EXPECT_EQ(shape_of<SpheresShape>(scene, 6).spheres.at(1).radius, 2);
  EXPECT_EQ(shape_of<SpheresShape>(scene, 7).spheres.at(1).center, (Vec3d{1, 1, 1}));
  EXPECT_EQ(shape_of<SpheresShape>(scene, 7).spheres.at(0).radius, 0.5);
}

TEST(SceneShape, ReadsSphereFiles) {
  SceneFiles files;
  files.dir.write("many.txt", "# x y z r\n1 2 3 4\r\n\n  -1e-1\t+.5 0 0.25 # small\n0 0 0 0\n7 8 9 1");
  const Scene scene = files.load_v1("objects: [{spheres: {file: many.txt}}]\n");
  const auto& spheres = shape_of<SpheresShape>(scene).spheres;
  ASSERT_EQ(spheres.size(), 3u);
  EXPECT_EQ(spheres[1].center, (Vec3d{-0.1, 0.5, 0}));
  EXPECT_EQ(spheres[2].radius, 1);
  ASSERT_EQ(scene.warnings.size(), 1u);
  expect_starts(files.without_directory(to_string(scene.warnings[0])),
                "many.txt:5:1: warning: the radius is zero");
}

TEST(SceneShape, SphereFileErrorsHaveTheirPlace) {
  SceneFiles files;
  const auto error = [&](const std::string& text) {
    files.dir.write("s.txt", text);
    return files.error_v1("objects: [{spheres: {file: s.txt}}]\n");
  };
  EXPECT_EQ(error("1 2 3 4\n1 2 x 4\n"), "s.txt:2:5: expected a number");
  EXPECT_EQ(error("1 2 3\n"), "s.txt:1:6: expected 4 numbers (x y z radius), found fewer");
  EXPECT_EQ(error("1 2 3 4 5\n"), "s.txt:1:9: expected 4 numbers (x y z radius), found more");
  EXPECT_EQ(error("1 2 3 -4\n"), "s.txt:1:7: expected a radius of at least 0");
  EXPECT_EQ(error("1 2 nan 4\n"), "s.txt:1:5: number not finite or out of range");
  EXPECT_EQ(error("1 2 1e999 4\n"), "s.txt:1:5: number not finite or out of range");
  EXPECT_EQ(error("1 2 3,4\n"), "s.txt:1:5: expected a number");
}

/// A shape that cannot be hit is skipped with a warning that names its line; the others are kept.
TEST(SceneShape, DegenerateShapesAreSkipped) {
  expect_skipped(
      {{"sphere: {radius: 0}", "scene.yaml:2:13: warning: the radius is zero; the object is skipped"},
       {"disk: {radius: 0}", "scene.yaml:2:13: warning: the radius is zero"},
       {"disk: {normal: [0, 0, 0]}", "scene.yaml:2:13: warning: the normal is zero"},
       {"plane: {normal: [0, 0, 0]}", "scene.yaml:2:13: warning: the normal is zero"},
       {"box: {min: [1, 1, 1], max: [1, 1, 1]}", "scene.yaml:2:13: warning: the box has no area"},
       {"box: {min: [1, 1, 0], max: [1, 1, 1]}", "scene.yaml:2:13: warning: the box has no area"},
       {"triangle: {vertices: [[0, 0, 0], [1, 1, 1], [2, 2, 2]]}",
        "scene.yaml:2:13: warning: the triangle has no area"},
       {"polygon: {vertices: [[0, 0, 0], [1, 1, 1], [2, 2, 2]]}",
        "scene.yaml:2:13: warning: the polygon has no area"},
       {"polygon: {vertices: [[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, 0]]}",
        "scene.yaml:2:13: warning: the polygon is not planar"},
       {"polygon: {vertices: [[0, 0, 0], [3, 0, 0], [0, 1, 0], [2, 2, 0]]}",
        "scene.yaml:2:13: warning: the polygon is not simple"},
       {"polygon: {vertices: [[0, 0, 0], [2, 0, 0], [2, 2, 0], [1, 0, 0], [0, 2, 0]]}",
        "scene.yaml:2:13: warning: the polygon is not simple"},
       {"polygon: {vertices: [[0, 0, 0], [2, 0, 0], [4, 0, 0], [2, 0, 0], [2, 2, 0]]}",
        "scene.yaml:2:13: warning: the polygon is not simple"},
       {"spheres: []", "scene.yaml:2:13: warning: there are no spheres"},
       {"spheres: [{radius: 0}]", "scene.yaml:2:23: warning: the radius is zero; the sphere is skipped", 2},
       {"sphere: {}, transform: {scale: [1, 0, 1]}", "scene.yaml:2:36: warning: the transform is singular"},
       {"group: [{sphere: {}}], transform: {scale: 0}",
        "scene.yaml:2:47: warning: the transform is singular; the group is skipped"},
       {"sphere: {}, transform: [{scale: 1e12}, {scale: 1e12}]",
        "scene.yaml:2:36: warning: the transform moves things out of range"}});
}

TEST(SceneShape, PolygonsMayBeConcaveAndTurnEitherWay) {
  std::string comb = "objects: [{polygon: {vertices: [[0, -1, 0]";
  for (int i = 0; i < 500; ++i)
    comb += ", [" + std::to_string(i) + ", 5, 0], [" + std::to_string(i) + ".5, 0, 0]";
  comb += ", [500, -1, 0]]}}]\n";
  const Scene scene = SceneFiles().load_v1(comb);
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(shape_of<PolygonShape>(scene).vertices.size(), 1002u);
}

TEST(SceneShape, OviHaveTwoRadii) {
  const Scene scene = SceneFiles().load_v1(
      "objects: [{ovus: }, {ovus: {bottom_radius: 2, top_radius: 3.5, normals: central}}]\n");
  EXPECT_TRUE(scene.warnings.empty());
  const auto& usual = std::get<OvusShape>(shape_of<ExactShape>(scene, 0).form);
  EXPECT_EQ(usual.bottom_radius, 1);
  EXPECT_EQ(usual.top_radius, 0.6);
  const auto& tall = std::get<OvusShape>(shape_of<ExactShape>(scene, 1).form);
  EXPECT_EQ(tall.bottom_radius, 2);
  EXPECT_EQ(tall.top_radius, 3.5);
  EXPECT_EQ(shape_of<ExactShape>(scene, 1).normals, NormalMethod::central);
  expect_errors(
      {{"objects: [{ovus: {top_radius: 2}}]",
        "scene.yaml:2:31: the top radius must be less than twice the bottom radius"},
       {"objects: [{ovus: {bottom_radius: -1}}]", "scene.yaml:2:34: expected a number of at least 0"},
       {"objects: [{ovus: {radius: 1}}]", "scene.yaml:2:19: unknown key 'radius' in ovus"}});
  expect_skipped({{"ovus: {bottom_radius: 0}", "scene.yaml:2:13: warning: the bottom radius is zero"},
                  {"ovus: {top_radius: 0}", "scene.yaml:2:13: warning: the top radius is zero"}});
}

TEST(SceneShape, WarningsAreBounded) {
  std::string text = "objects:\n";
  for (int i = 0; i < 3000; ++i) text += "  - sphere: {radius: 0}\n";
  const Scene scene = SceneFiles().load_v1(text);
  ASSERT_EQ(scene.warnings.size(), 1001u);
  EXPECT_EQ(to_string(scene.warnings.back()), "warning: there are more warnings, which are not shown");
}

}  // namespace
}  // namespace oktett::scene_shape_test
