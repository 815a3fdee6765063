#include <gtest/gtest.h>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_quadrics_test {
namespace {

using test::expect_errors;
using test::expect_skipped;
using test::SceneFiles;

template <class T>
const T& form_of(const Scene& scene, std::size_t i) {
  return std::get<T>(test::shape_of<ExactShape>(scene, i).form);
}

using Coefficients = std::array<double, 10>;

TEST(SceneQuadrics, HaveNaturalDefaults) {
  const Scene scene = SceneFiles().load_v1(
      "objects: [{cylinder: }, {cone: }, {quadric: }, {infinite_cylinder: }, {paraboloid: }, {hyperboloid: "
      "}, "
      "{hyperboloid: {sheets: 2}}]\n");
  EXPECT_TRUE(scene.warnings.empty());
  const auto& cylinder = form_of<CylinderShape>(scene, 0);
  EXPECT_EQ(cylinder.from, (Vec3d{0, -1, 0}));
  EXPECT_EQ(cylinder.to, (Vec3d{0, 1, 0}));
  EXPECT_EQ(cylinder.radius, 1);
  EXPECT_FALSE(cylinder.open);
  const auto& cone = form_of<ConeShape>(scene, 1);
  EXPECT_EQ(cone.from, (Vec3d{0, -1, 0}));
  EXPECT_EQ(cone.from_radius, 1);
  EXPECT_EQ(cone.to_radius, 0);
  const Coefficients kinds[] = {{1, 1, 1, 0, 0, 0, 0, 0, 0, -1},
                                {1, 1, 0, 0, 0, 0, 0, 0, 0, -1},
                                {1, 1, 0, 0, 0, 0, 0, 0, -1, 0},
                                {1, 1, -1, 0, 0, 0, 0, 0, 0, -1},
                                {1, 1, -1, 0, 0, 0, 0, 0, 0, 1}};
  for (std::size_t i = 0; i < std::size(kinds); ++i) {
    EXPECT_EQ(form_of<QuadricShape>(scene, 2 + i).coefficients, kinds[i]) << i;
    EXPECT_FALSE(form_of<QuadricShape>(scene, 2 + i).clipped);
  }
}

TEST(SceneQuadrics, ReadAllParameters) {
  const Scene scene = SceneFiles().load_v1(
      "objects:\n"
      "  - cylinder: {from: [1, 2, 3], to: [4, 5, 6], radius: 0.5, open: true, normals: central}\n"
      "  - cone: {from: [1, 2, 3], to: [4, 5, 6], from_radius: 0, to_radius: 2, open: true}\n"
      "  - polyhedron: {planes: [[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1], [-1, -2, -3, 4]]}\n"
      "  - quadric: {coefficients: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10], clip: {min: [-1, -2, -3], max: [1, 2, "
      "3]}}\n"
      "  - paraboloid: {clip: , open: true}\n");
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(test::shape_of<ExactShape>(scene, 0).normals, NormalMethod::central);
  EXPECT_EQ(form_of<CylinderShape>(scene, 0).to, (Vec3d{4, 5, 6}));
  EXPECT_EQ(form_of<CylinderShape>(scene, 0).radius, 0.5);
  EXPECT_TRUE(form_of<CylinderShape>(scene, 0).open);
  EXPECT_EQ(form_of<ConeShape>(scene, 1).to_radius, 2);
  EXPECT_TRUE(form_of<ConeShape>(scene, 1).open);
  ASSERT_EQ(form_of<PolyhedronShape>(scene, 2).planes.size(), 4u);
  EXPECT_EQ(form_of<PolyhedronShape>(scene, 2).planes[3].normal, (Vec3d{-1, -2, -3}));
  EXPECT_EQ(form_of<PolyhedronShape>(scene, 2).planes[3].offset, 4);
  const auto& quadric = form_of<QuadricShape>(scene, 3);
  EXPECT_EQ(quadric.coefficients, (Coefficients{1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
  EXPECT_TRUE(quadric.clipped);
  EXPECT_EQ(quadric.lo, (Vec3d{-1, -2, -3}));
  EXPECT_EQ(quadric.hi, (Vec3d{1, 2, 3}));
  EXPECT_TRUE(form_of<QuadricShape>(scene, 4).clipped) << "the unit box";
  EXPECT_EQ(form_of<QuadricShape>(scene, 4).hi, (Vec3d{1, 1, 1}));
  EXPECT_TRUE(form_of<QuadricShape>(scene, 4).open);
}

TEST(SceneQuadrics, ErrorsHaveTheirPlace) {
  std::string many = "objects: [{polyhedron: {planes: [[1, 0, 0, 1]";
  for (int i = 0; i < 1024; ++i) many += ", [0, 1, 0, 1]";
  many += "]}}]";
  expect_errors(
      {{"objects: [{cylinder: {radius: -1}}]",
        "scene.yaml:2:31: expected a number of at least 0, found '-1'"},
       {"objects: [{cylinder: {from: 1}}]", "scene.yaml:2:29: expected a list of 3 numbers, found '1'"},
       {"objects: [{cylinder: {top: [0, 0, 0]}}]",
        "scene.yaml:2:23: unknown key 'top' in cylinder; did you mean"},
       {"objects: [{cylinder: {open: 1}}]", "scene.yaml:2:29: expected true or false, found '1'"},
       {"objects: [{cone: {radius: 1}}]", "scene.yaml:2:19: unknown key 'radius' in cone"},
       {"objects: [{cone: {to_radius: .nan}}]", "scene.yaml:2:30: expected a finite number"},
       {"objects: [{cone: {from_radius: -0.5}}]", "scene.yaml:2:32: expected a number of at least 0"},
       {"objects: [{polyhedron: {}}]", "scene.yaml:2:24: polyhedron needs 'planes'"},
       {"objects: [{polyhedron: {planes: [[1, 0, 0]]}}]", "scene.yaml:2:34: expected 4 numbers, found 3"},
       {"objects: [{polyhedron: {planes: [[0, 0, 0, 1]]}}]",
        "scene.yaml:2:34: the normal of a plane must not be zero"},
       {"objects: [{polyhedron: {planes: [[1, 0, 0, 1], [-1, 0, 0, 1]]}}]",
        "scene.yaml:2:33: the planes do not bound a solid on all sides"},
       {"objects: [{polyhedron: {planes: []}}]", "scene.yaml:2:33: the planes do not bound a solid"},
       {many, "scene.yaml:2:33: expected at most 1024 planes, found 1025"},
       {"objects: [{quadric: {coefficients: [1, 1, 1]}}]", "scene.yaml:2:36: expected 10 numbers, found 3"},
       {"objects: [{quadric: {clip: {min: [0, 3, 0]}}}]",
        "scene.yaml:2:34: the clip box has min > max along y"},
       {"objects: [{quadric: {clip: {max: [-2, 0, 0]}}}]",
        "scene.yaml:2:34: the clip box has min > max along x"},
       {"objects: [{quadric: {clip: {min: [0, 0, 1.5]}}}]",
        "scene.yaml:2:34: the clip box has min > max along z"},
       {"objects: [{quadric: {clip: {low: 1}}}]", "scene.yaml:2:29: unknown key 'low' in clip"},
       {"objects: [{infinite_cylinder: {radius: 1}}]",
        "scene.yaml:2:32: unknown key 'radius' in infinite_cylinder"},
       {"objects: [{paraboloid: {sheets: 1}}]", "scene.yaml:2:25: unknown key 'sheets' in paraboloid"},
       {"objects: [{hyperboloid: {sheets: 3}}]",
        "scene.yaml:2:34: expected a whole number from 1 to 2, found '3'"},
       {"objects: [{hyperboloid: {normals: exact}}]",
        "scene.yaml:2:35: expected gradient or forward or central"}});
}

TEST(SceneQuadrics, DegenerateOnesAreSkipped) {
  expect_skipped(
      {{"cylinder: {radius: 0}", "scene.yaml:2:13: warning: the radius is zero; the object is skipped"},
       {"cylinder: {from: [1, 1, 1], to: [1, 1, 1]}",
        "scene.yaml:2:13: warning: the ends of the axis coincide; the object is skipped"},
       {"cone: {from: [0, 1, 0]}", "scene.yaml:2:13: warning: the ends of the axis coincide"},
       {"cone: {from_radius: 0}", "scene.yaml:2:13: warning: both radii are zero"},
       {"polyhedron: {planes: [[1, 0, 0, -2], [-1, 0, 0, 1], [0, 1, 0, 1], [0, -1, 0, 1], [0, 0, 1, 1], "
        "[0, 0, -1, 1]]}",
        "scene.yaml:2:13: warning: there is nothing inside of all planes; the object is skipped"},
       {"quadric: {coefficients: [0, 0, 0, 0, 0, 0, 0, 0, 0, 1]}",
        "scene.yaml:2:13: warning: the equation does not depend on x, y or z"},
       // A box without thickness is no error, along no axis.
       {"paraboloid: {clip: {min: [1, 0, 0]}}", "scene.yaml:2:13: warning: the clip box has no volume"},
       {"paraboloid: {clip: {min: [0, 1, 0]}}", "scene.yaml:2:13: warning: the clip box has no volume"},
       {"paraboloid: {clip: {min: [0, 0, 1]}}", "scene.yaml:2:13: warning: the clip box has no volume"},
       {"quadric: {clip: {min: [1, 2, 3], max: [1, 2, 3]}}",
        "scene.yaml:2:13: warning: the clip box has no volume"}});
}

}  // namespace
}  // namespace oktett::scene_quadrics_test
