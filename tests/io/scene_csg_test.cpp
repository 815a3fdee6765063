#include <gtest/gtest.h>

#include "render/solids.h"
#include "tests/io/scene_test_support.h"

namespace oktett::scene_csg_test {
namespace {

using test::expect_starts;
using test::SceneFiles;

const CsgShape& csg(const Scene& scene, std::size_t i = 0) { return test::shape_of<CsgShape>(scene, i); }
const Object& operand(const CsgShape& shape, std::size_t i) { return shape.operands->at(i); }

constexpr const char* kTetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
/// The same without its last triangle.
constexpr const char* kOpened = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n";

TEST(SceneCsg, ReadsEachOperationAtAnyDepth) {
  const Scene scene = SceneFiles().load_v1(
      "objects:\n"
      "  - difference:\n"
      "      - intersection: [{box: }, {sphere: }]\n"
      "      - union: [{cylinder: }, {torus: }, {infinite_cylinder: }]\n"
      "      - plane:\n");
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.objects.size(), 1u);
  const CsgShape& top = csg(scene);
  EXPECT_EQ(top.op, CsgOp::subtract);
  ASSERT_EQ(top.operands->size(), 3u);
  EXPECT_EQ(std::get<CsgShape>(operand(top, 0).shape).op, CsgOp::intersect);
  EXPECT_EQ(std::get<CsgShape>(operand(top, 1).shape).op, CsgOp::unite);
  EXPECT_EQ(std::get<CsgShape>(operand(top, 1).shape).operands->size(), 3u);
  EXPECT_TRUE(std::holds_alternative<PlaneShape>(operand(top, 2).shape));
}

/// An operand without a material shows that of the combination.
TEST(SceneCsg, OperandsKeepTheirMaterials) {
  const Scene scene = SceneFiles().load_v1(
      "materials: {red: {color: [1, 0, 0]}, blue: {color: [0, 0, 1]}}\n"
      "objects:\n"
      "  - union: [{sphere: , material: red}, {union: [{box: }, {box: , material: red}]}]\n"
      "    material: blue\n");
  const CsgShape& top = csg(scene);
  EXPECT_EQ(operand(top, 0).material, 0u);
  const CsgShape& inner = std::get<CsgShape>(operand(top, 1).shape);
  EXPECT_EQ(operand(inner, 0).material, 1u);
  EXPECT_EQ(operand(inner, 1).material, 0u);
}

/// The combination's own transform applies to all operands, a group's to its members.
TEST(SceneCsg, TransformsAreNested) {
  const Scene scene = SceneFiles().load_v1(
      "objects:\n"
      "  - difference:\n"
      "      - group: [{sphere: , transform: {translate: [0, 1, 0]}}, {box: }]\n"
      "        transform: {translate: [1, 0, 0]}\n"
      "      - {sphere: , transform: {scale: 2}}\n"
      "    transform: {translate: [0, 0, 5]}\n");
  const CsgShape& top = csg(scene);
  EXPECT_EQ(scene.objects[0].transform.point({0, 0, 0}), (Vec3d{0, 0, 5}));
  const CsgShape& group = std::get<CsgShape>(operand(top, 0).shape);
  EXPECT_EQ(group.op, CsgOp::unite);
  const Affine whole = operand(top, 0).transform * operand(group, 0).transform;
  EXPECT_EQ(whole.point({0, 0, 0}), (Vec3d{1, 1, 0}));
  EXPECT_EQ(operand(top, 1).transform.point({1, 0, 0}), (Vec3d{2, 0, 0}));
}

TEST(SceneCsg, WhatHasNoInsideIsRefused) {
  const SceneFiles files;
  const auto error = [&](const std::string& operand) {
    return files.error_v1("define: {flat: {disk: }}\nobjects:\n  - union:\n      - sphere:\n      - " +
                          operand + "\n");
  };
  for (const char* flat :
       {"disk:", "triangle:", "polygon: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}",
        "cylinder: {open: true}", "paraboloid: {clip: , open: true}",
        "polynomial: {equation: x^4 + y^4 = z, bounds: {min: [-1, -1, -1], max: [1, 1, 1]}, open: true}"})
    EXPECT_NE(error(flat).find("has no inside; only solids can be combined"), std::string::npos)
        << flat << ": " << error(flat);
  expect_starts(error("disk:"), "scene.yaml:6:9: a disk has no inside");
  expect_starts(error("instance: flat"), "scene.yaml:6:9: in prototype 'flat': a disk has no inside");
  expect_starts(error("group: [{sphere: }, {disk: }]"), "scene.yaml:6:29: a disk has no inside");
  EXPECT_EQ(error("paraboloid: {open: true}"), "no error");
}

TEST(SceneCsg, SurfacesAreOperands) {
  const SceneFiles files;
  const Scene scene = files.load_v1(
      "define: {flat: {disk: }}\nobjects:\n  - intersection:\n      - sphere:\n"
      "      - surfaces: [{disk: }, {group: [{instance: flat}, {cylinder: {open: true}}]}]\n"
      "        transform: {translate: [1, 0, 0]}\n");
  const CsgShape& cut = std::get<CsgShape>(operand(csg(scene), 1).shape);
  EXPECT_EQ(cut.op, CsgOp::surfaces);
  EXPECT_EQ(cut.operands->size(), 3u);
  EXPECT_EQ(operand(csg(scene), 1).transform.point({0, 0, 0}), (Vec3d{1, 0, 0}));
  EXPECT_FALSE(is_solid(scene.objects[0].shape, scene.prototypes));
  const auto error = [&](const std::string& object) {
    return files.error_v1("materials: {glass: {transparency: 1, priority: 1}}\nobjects:\n  - " + object +
                          "\n");
  };
  expect_starts(error("surfaces: [{disk: }]"),
                "scene.yaml:4:5: 'surfaces' are seen as the solids around them let");
  expect_starts(error("union: [{surfaces: [{union: [{box: }]}]}]"),
                "scene.yaml:4:25: a combination is an operand itself");
  expect_starts(error("union: [{surfaces: [{box: , material: glass}]}]"),
                "scene.yaml:4:25: surfaces alone have no inside");
  expect_starts(error("{union: [{box: }], seen_through: [{surfaces: [{box: }]}]}"),
                "scene.yaml:4:39: surfaces have no inside; only solids can be seen through");
}

TEST(SceneCsg, MeshesAreClosedOrTakenByWinding) {
  const SceneFiles files;
  files.dir.write("closed.obj", kTetrahedron);
  files.dir.write("open.obj", kOpened);
  const std::string before = "objects:\n  - difference:\n      - box:\n      - mesh: ";
  EXPECT_EQ(files.error_v1(before + "{file: closed.obj}\n"), "no error");
  expect_starts(
      files.error_v1(before + "{file: open.obj}\n"),
      "scene.yaml:5:9: the mesh is not closed: 3 open edges, the first from (0, 0, 0) to (0, 1, 0)");
  EXPECT_EQ(files.error_v1(before + "{file: open.obj, solid: winding}\n"), "no error");
  const Scene scene = files.load_v1(before + "{file: open.obj, solid: winding}\n");
  EXPECT_TRUE(std::get<MeshShape>(operand(csg(scene), 1).shape).by_winding);
  expect_starts(files.error_v1(before + "{file: open.obj, solid: maybe}\n"), "scene.yaml:5:39: ");
  // Elsewhere meshes may be open.
  EXPECT_EQ(files.error_v1("objects:\n  - mesh: {file: open.obj}\n"), "no error");
}

/// Files often repeat the vertices where normals or texture coordinates differ.
TEST(SceneCsg, VerticesAtOnePlaceCloseAMesh) {
  const SceneFiles files;
  files.dir.write("split.obj",
                  "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv -0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                  "f 1 3 2\nf 5 6 8\nf 2 3 4\nf 1 8 7\n");
  EXPECT_EQ(files.error_v1("objects:\n  - union: [{mesh: {file: split.obj}}]\n"), "no error");
}

/// A skipped operand is empty: a difference keeps its first operand, an intersection becomes empty.
TEST(SceneCsg, SkippedOperandsAreNothing) {
  const auto load = [](const std::string& shape) {
    return SceneFiles().load_v1("objects:\n  - " + shape + "\n  - sphere:\n");
  };
  const std::string nothing = "{sphere: {radius: 0}}";
  EXPECT_EQ(load("difference: [{box: }, " + nothing + "]").objects.size(), 2u);
  EXPECT_EQ(load("union: [{box: }, " + nothing + "]").objects.size(), 2u);
  EXPECT_EQ(load("difference: [" + nothing + ", {box: }]").objects.size(), 1u);
  EXPECT_EQ(load("intersection: [{box: }, " + nothing + "]").objects.size(), 1u);
  EXPECT_EQ(load("union: [" + nothing + "]").warnings.size(), 2u);
  const Scene flattened = load("{union: [{box: }], transform: {scale: [1, 0, 1]}}");
  EXPECT_EQ(flattened.objects.size(), 1u);
  EXPECT_EQ(flattened.warnings.size(), 1u);
}

TEST(SceneCsg, ReadsWhatCombinationsAreSeenThrough) {
  const SceneFiles files;
  const Scene scene = files.load_v1(
      "objects:\n"
      "  - union: [{sphere: }]\n"
      "    seen_through: [{box: }, {union: [{sphere: }, {plane: }], transform: {translate: [1, 2, 3]}}]\n"
      "    transform: {translate: [4, 0, 0]}\n");
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.objects.size(), 1u);
  const auto& windows = csg(scene).windows;
  ASSERT_NE(windows, nullptr);
  ASSERT_EQ(windows->size(), 2u);
  EXPECT_TRUE(std::holds_alternative<BoxShape>((*windows)[0].shape));
  EXPECT_TRUE((*windows)[0].transform.is_identity());
  EXPECT_EQ((*windows)[1].transform.point({0, 0, 0}), (Vec3d{1, 2, 3}));

  const auto error = [&](const std::string& object) { return files.error_v1("objects:\n  - " + object); };
  expect_starts(error("{sphere: , seen_through: [{box: }]}\n"),
                "scene.yaml:3:30: only combinations are seen through solids");
  expect_starts(error("{union: [{union: [{sphere: }], seen_through: [{box: }]}]}\n"),
                "scene.yaml:3:50: what is in a combination is seen as the combination is");
  expect_starts(error("{union: [{sphere: }], seen_through: [{disk: }]}\n"),
                "scene.yaml:3:42: a disk has no inside; only solids can be seen through");
  expect_starts(error("{union: [{sphere: }], seen_through: []}\n"),
                "scene.yaml:3:41: seen_through needs at least one solid");
  files.dir.write("solid.obj", kTetrahedron);
  expect_starts(error("{union: [{sphere: }], seen_through: [{mesh: {file: solid.obj}}]}\n"),
                "scene.yaml:3:42: meshes and instances cannot be seen through");
}

TEST(SceneCsg, BadCombinationsAreExplained) {
  const SceneFiles files;
  expect_starts(files.error_v1("objects:\n  - union: []\n"), "scene.yaml:3:5: union needs at least one");
  expect_starts(files.error_v1("objects:\n  - unoin: []\n"), "scene.yaml:3:5: unknown key");
  const auto nested = [&](int levels) {
    std::string deep = "sphere: ";
    for (int i = 0; i < levels; ++i) deep = "union: [{" + deep + "}]";
    return files.error_v1("objects: [{" + deep + "}]\n");
  };
  EXPECT_EQ(nested(48), "no error");
  EXPECT_NE(nested(49).find("nested deeper than 100 levels"), std::string::npos);
}

}  // namespace
}  // namespace oktett::scene_csg_test
