#include <gtest/gtest.h>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_patches_test {
namespace {

using test::expect_starts;
using test::SceneFiles;

const std::string kPatch =
    "[[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [0, 1, 0], [1, 1, 5], [2, 1, 0], [3, 1, 0], [0, 2, 0], [1, "
    "2, 0], [2, 2, 0], [3, 2, 0], [0, 3, 0], [1, 3, 0], [2, 3, 0], [3, 3, 0]]";

TEST(ScenePatches, ReadsPatchesAndFunctions) {
  const Scene scene = SceneFiles().load_v1(
      "objects:\n"
      "  - bezier_patch: {patches: [" +
      kPatch + ", " + kPatch +
      "], uv: [0, 0, 2, 0, 2, 3, 0, 3], open: false}\n"
      "  - parametric: {x: u + v, y: u - v, z: u*v, from: [-1, -2], to: [2*pi, 3], clip: {max: [1, 2, "
      "3]}}\n");
  EXPECT_TRUE(scene.warnings.empty());
  const auto& patch = std::get<BezierPatchShape>(test::shape_of<ExactShape>(scene, 0).form);
  ASSERT_EQ(patch.patches.size(), 2u);
  EXPECT_EQ(patch.patches[1].p[5], (Vec3d{1, 1, 5}));
  EXPECT_EQ(patch.uv[4], 2);
  EXPECT_EQ(patch.uv[5], 3);
  EXPECT_FALSE(patch.open);
  const auto& s = std::get<ParametricShape>(test::shape_of<ExactShape>(scene, 1).form);
  EXPECT_EQ(value_at(s.x.tape, 3, 5, 0), 8);
  EXPECT_EQ(value_at(s.z.tape, 3, 5, 0), 15);
  EXPECT_EQ(s.from[1], -2);
  EXPECT_EQ(s.to[1], 3);
  EXPECT_TRUE(s.cut);
  EXPECT_EQ(s.hi.z, 3);
}

TEST(ScenePatches, ErrorsHaveTheirPlace) {
  const struct {
    std::string object, error;
  } kCases[] = {
      {"bezier_patch: {patches: []}", "scene.yaml:2:36: expected 1 to"},
      {"bezier_patch: {patches: [[[0, 0, 0]]]}", "scene.yaml:2:37: expected 16 points, found 1"},
      {"bezier_patch: {uv: [1, 2], patches: [" + kPatch + "]}",
       "scene.yaml:2:31: expected 8 numbers, found 2"},
      {"parametric: {x: u, y: v}", "scene.yaml:2:24: parametric needs 'z'"},
      {"parametric: {x: x, y: v, z: 0}", "scene.yaml:2:28: bad function: unknown name 'x'"},
      {"parametric: {x: u, y: v, z: 0, from: [1, 0], to: [1, 2]}",
       "scene.yaml:2:61: the greatest u must be greater than the least"},
      {"parametric: {x: u, y: v, z: 0, clip: {max: [1, 1, 1]}, open: false}",
       "scene.yaml:2:73: a surface that is cut does not surround a solid"},
  };
  SceneFiles files;
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.object);
    expect_starts(files.error_v1("objects: [{" + c.object + "}]"), c.error);
  }
}

TEST(ScenePatches, WhatHasNoPointsIsSkipped) {
  std::string point = "[1, 2, 3]", patch = point;
  for (int k = 1; k < 16; ++k) patch += ", " + point;
  for (const std::string& object : {"bezier_patch: {patches: [[" + patch + "]]}",
                                    std::string("parametric: {x: sqrt(-1 - u^2), y: v, z: u}")}) {
    const Scene scene = SceneFiles().load_v1("objects:\n  - " + object + "\n");
    EXPECT_EQ(scene.warnings.size(), 1u) << object;
    EXPECT_TRUE(scene.objects.empty());
  }
}

}  // namespace
}  // namespace oktett::scene_patches_test
