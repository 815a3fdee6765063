#include <gtest/gtest.h>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_metaballs_test {
namespace {

using test::expect_starts;
using test::SceneFiles;
using test::shape_of;

template <class T>
const T& form_of(const Scene& scene, std::size_t i = 0) {
  return std::get<T>(shape_of<ExactShape>(scene, i).form);
}

TEST(SceneMetaballs, ReadsEveryParameter) {
  SceneFiles files;
  files.dir.write("balls.txt", "# x y z radius strength\n0 0 0 1\n\n1 2 3 0.5 -2 # a dent\n");
  const Scene scene = files.load_v1(
      "objects:\n"
      "  - metaballs: {iso: 0.25, balls: [{center: [1, 2, 3], radius: 4, strength: -5}, {}]}\n"
      "  - metaballs: {file: balls.txt}\n"
      "  - metaballs: {elements: [{point: [1, 2, 3], radius: 2, weight: 3}]}\n"
      "  - metaballs:\n"
      "      elements:\n"
      "        - {segment: {from: [1, 0, 0], to: [2, 0, 0]}, potential: gaussian, b: 3}\n"
      "        - {polygon: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], potential: quadratic, b: 2}\n"
      "        - {ellipsoid: {center: [1, 1, 1], radii: [1, 2, 3], rotate: [10, 20, 30]}, potential: "
      "rational,\n"
      "           d: 4, radius: 2}\n"
      "        - {point: {center: [0, 1, 0]}, potential: inverse_square}\n"
      "  - blobtree:\n"
      "      iso: 0.3\n"
      "      difference:\n"
      "        - max: [{point: [0, 0, 0]}, {min: [{segment: {}}, {point: [0, 1, 0]}]}]\n"
      "        - {polygon: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}, weight: -1}\n");
  EXPECT_TRUE(scene.warnings.empty());
  const auto& a = form_of<MetaballsShape>(scene, 0);
  EXPECT_EQ(a.iso, 0.25);
  ASSERT_EQ(a.balls.size(), 2u);
  EXPECT_EQ(a.balls[0].center, (Vec3d{1, 2, 3}));
  EXPECT_EQ(a.balls[0].radius, 4);
  EXPECT_EQ(a.balls[0].strength, -5);
  const auto& b = form_of<MetaballsShape>(scene, 1);
  ASSERT_EQ(b.balls.size(), 2u);
  EXPECT_EQ(b.balls[0].strength, 1);
  EXPECT_EQ(b.balls[1].radius, 0.5);
  EXPECT_EQ(b.balls[1].strength, -2);
  EXPECT_EQ(form_of<MetaballsShape>(scene, 2).balls[0].strength, 3);
  const auto& c = form_of<BlobTreeShape>(scene, 3);
  ASSERT_EQ(c.elements.size(), 4u);
  EXPECT_EQ(std::get<SegmentSkeleton>(c.elements[0].skeleton).to, (Vec3d{2, 0, 0}));
  EXPECT_EQ(c.elements[0].potential.kind, PotentialKind::gaussian);
  EXPECT_EQ(c.elements[0].potential.scale, 3);
  EXPECT_EQ(std::get<PolygonSkeleton>(c.elements[1].skeleton).vertices.size(), 3u);
  EXPECT_EQ(std::get<EllipsoidSkeleton>(c.elements[2].skeleton).rotation, (Vec3d{10, 20, 30}));
  EXPECT_EQ(c.elements[2].potential.d, 4);
  EXPECT_EQ(c.elements[3].potential.kind, PotentialKind::inverse_square);
  EXPECT_EQ(c.blends.back().count, 4u);
  const auto& d = form_of<BlobTreeShape>(scene, 4);
  EXPECT_EQ(d.iso, 0.3);
  EXPECT_EQ(d.elements.size(), 4u);
  ASSERT_EQ(d.blends.size(), 7u);
  EXPECT_EQ(d.blends[3].op, Blend::Op::min);
  EXPECT_EQ(d.blends[4].op, Blend::Op::max);
  EXPECT_EQ(d.blends[6].op, Blend::Op::difference);
}

/// Where all is of one potential and nothing flat.
TEST(SceneMetaballs, ElementsOfOnePotentialAreBalls) {
  SceneFiles files;
  const Scene scene = files.load_v1(
      "objects:\n"
      "  - metaballs:\n"
      "      iso: 0.25\n"
      "      elements:\n"
      "        - {segment: {from: [0, 1, 0], to: [2, 0, 0]}, radius: 3, weight: 2}\n"
      "        - {point: [1, 2, 3], radius: 4}\n"
      "        - {ellipsoid: {center: [0, 1, 0], radii: [1, 2, 3]}, radius: 0.5, weight: -1}\n");
  const auto& shape = form_of<MetaballsShape>(scene, 0);
  EXPECT_EQ(shape.iso, 0.25);
  ASSERT_EQ(shape.balls.size(), 1u);
  EXPECT_EQ(shape.balls[0].center, (Vec3d{1, 2, 3}));
  EXPECT_EQ(shape.balls[0].radius, 4);
  ASSERT_EQ(shape.elements.size(), 2u);
  EXPECT_EQ(std::get<SegmentSkeleton>(shape.elements[0].skeleton).to, (Vec3d{2, 0, 0}));
  EXPECT_EQ(shape.elements[0].potential.scale, 3);
  EXPECT_EQ(shape.elements[0].potential.weight, 2);
  EXPECT_EQ(std::get<EllipsoidSkeleton>(shape.elements[1].skeleton).radii, (Vec3d{1, 2, 3}));
}

TEST(SceneMetaballs, ErrorsHaveTheirPlace) {
  std::string deep = "{point: [0, 0, 0]}";
  for (int i = 0; i <= kMaxBlendLevels; ++i) deep = "{max: [" + deep + "]}";
  const struct {
    std::string object, error;
  } kCases[] = {
      {"metaballs: {}", "scene.yaml:2:23: metaballs need 'balls', 'file' or 'elements'"},
      {"metaballs: {balls: []}", "scene.yaml:2:31: expected 1 to 1048576 balls, found 0"},
      {"metaballs: {elements: []}", "scene.yaml:2:34: the list of elements is empty"},
      {"metaballs: {balls: [{radius: 0}]}", "scene.yaml:2:41: expected a number greater than 0"},
      {"metaballs: {balls: [{radius: -1}]}", "scene.yaml:2:41: expected a number greater than 0"},
      {"metaballs: {iso: 0, balls: [{}]}", "scene.yaml:2:29: expected a number greater than 0"},
      {"metaballs: {balls: [{radios: 1}]}", "scene.yaml:2:33: unknown key 'radios'"},
      {"metaballs: {balls: [{}], elements: []}", "scene.yaml:2:47: metaballs have one of"},
      {"metaballs: {elements: [{radius: 1}]}", "scene.yaml:2:35: expected a skeleton"},
      {"metaballs: {elements: [{point: [0, 0, 0], segment: {}}]}",
       "scene.yaml:2:63: an element has one skeleton"},
      {"metaballs: {elements: [{point: [0, 0, 0], potential: cubic}]}", "scene.yaml:2:65: expected "},
      {"metaballs: {elements: [{point: [0, 0, 0], b: 1}]}", "scene.yaml:2:57: this potential has no 'b'"},
      {"metaballs: {elements: [{ellipsoid: {radii: [1, 0, 1]}}]}",
       "scene.yaml:2:59: expected a number greater"},
      {"metaballs: {elements: [{polygon: [[0, 0, 0], [1, 0, 0]]}]}",
       "scene.yaml:2:45: expected at least 3 vertices"},
      {"metaballs: {elements: [{polygon: [[0, 0, 0], [1, 0, 0], [2, 0, 0]]}]}", "scene.yaml:2:45: "},
      {"blobtree: {}", "scene.yaml:2:22: a blobtree needs one of"},
      {"blobtree: {max: []}", "scene.yaml:2:28: the list of 'max' is empty"},
      {"blobtree: {max: [{point: [0, 0, 0]}], min: [{point: [0, 0, 0]}]}", "scene.yaml:2:"},
      {"blobtree: {max: [{mix: []}]}", "scene.yaml:2:"},
      {"blobtree: {max: [" + deep + "]}", "scene.yaml:2:"},
  };
  SceneFiles files;
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.object);
    expect_starts(files.error_v1("objects: [{" + c.object + "}]"), c.error);
  }
  EXPECT_NE(
      files.error_v1("objects: [{blobtree: {max: [" + deep + "]}}]").find("nested deeper than 32 levels"),
      std::string::npos);
  files.dir.write("balls.txt", "0 0 0 1\n0 0 0 0\n");
  EXPECT_NE(
      files.error_v1("objects: [{metaballs: {file: balls.txt}}]").find("balls.txt:2:7: expected a radius"),
      std::string::npos);
}

/// A shape without any surface is skipped with a warning.
TEST(SceneMetaballs, DegenerateOnesAreSkipped) {
  for (const char* object :
       {"metaballs: {balls: [{strength: -1}]}", "metaballs: {elements: [{point: [0, 0, 0], weight: -1}]}",
        "blobtree: {max: [{point: [0, 0, 0], weight: -1}]}"}) {
    SCOPED_TRACE(object);
    const Scene scene = SceneFiles().load_v1("objects: [{" + std::string(object) + "}]");
    EXPECT_TRUE(scene.objects.empty());
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].message.find("positive"), std::string::npos) << scene.warnings[0].message;
  }
}

}  // namespace
}  // namespace oktett::scene_metaballs_test
