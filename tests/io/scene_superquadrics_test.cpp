#include <gtest/gtest.h>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_superquadrics_test {
namespace {

using test::expect_errors;
using test::expect_skipped;
using test::SceneFiles;
using Form = SuperquadricShape::Form;

const SuperquadricShape& form_of(const Scene& scene, std::size_t i) {
  return std::get<SuperquadricShape>(test::shape_of<ExactShape>(scene, i).form);
}

TEST(SceneSuperquadrics, HaveNaturalDefaults) {
  const Scene scene = SceneFiles().load_v1(
      "objects: [{superellipsoid: }, {superhyperboloid: }, {supertoroid: }, {ratioellipsoid: }, "
      "{ratiohyperboloid: }, {ratiotoroid: }]\n");
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.objects.size(), 6u);
  constexpr Form kForms[] = {Form::ellipsoid, Form::hyperboloid, Form::toroid};
  for (std::size_t i = 0; i < 6; ++i) {
    const SuperquadricShape& s = form_of(scene, i);
    EXPECT_EQ(s.form, kForms[i % 3]);
    EXPECT_EQ(s.ratio, i >= 3);
    EXPECT_EQ(s.radii, (Vec3d{1, 1, 1}));
    EXPECT_EQ(s.q, s.form == Form::toroid ? 0.5 : 2);
  }
}

TEST(SceneSuperquadrics, ReadAllParameters) {
  const Scene scene = SceneFiles().load_v1(
      "objects:\n"
      "  - superellipsoid: {radii: [1, 2, 3], p: 4, q: 5, r: 0.5, normals: central}\n"
      "  - ratiohyperboloid: {radii: [3, 2, 1], p: 4, q: 5, r: 6, clip: {min: [-1, -2, -3], max: [1, 2, 3]}, "
      "open: true}\n"
      "  - supertoroid: {radii: [1, 2, 3], m: 1, n: 3, q: 0.25, r: 4, p: 5, d: 6, e: 7}\n");
  EXPECT_TRUE(scene.warnings.empty());
  const SuperquadricShape &a = form_of(scene, 0), &b = form_of(scene, 1), &c = form_of(scene, 2);
  EXPECT_EQ(test::shape_of<ExactShape>(scene, 0).normals, NormalMethod::central);
  EXPECT_EQ(a.radii, (Vec3d{1, 2, 3}));
  EXPECT_TRUE(a.p == 4 && a.q == 5 && a.r == 0.5);
  EXPECT_TRUE(b.p == 4 && b.q == 5 && b.r == 6 && b.open && b.ratio);
  EXPECT_EQ(b.lo, (Vec3d{-1, -2, -3}));
  EXPECT_EQ(b.hi, (Vec3d{1, 2, 3}));
  EXPECT_TRUE(c.m == 1 && c.n == 3 && c.q == 0.25 && c.r == 4 && c.p == 5 && c.d == 6 && c.e == 7);
}

TEST(SceneSuperquadrics, ErrorsHaveTheirPlace) {
  expect_errors(
      {{"objects: [{superellipsoid: {p: 0}}]", "scene.yaml:2:32: expected a number greater than 0"},
       {"objects: [{superellipsoid: {q: -2}}]", "scene.yaml:2:32: expected a number greater than 0"},
       {"objects: [{superellipsoid: {r: .nan}}]", "scene.yaml:2:32: expected a finite number"},
       {"objects: [{superellipsoid: {r: 2000}}]", "scene.yaml:2:32: expected a number greater than 0"},
       {"objects: [{superellipsoid: {radii: [1, -1, 1]}}]",
        "scene.yaml:2:36: the radii must not be negative"},
       {"objects: [{superellipsoid: {radii: 1}}]", "scene.yaml:2:36: expected a list of 3 numbers"},
       {"objects: [{superellipsoid: {open: true}}]", "scene.yaml:2:29: unknown key 'open' in superellipsoid"},
       {"objects: [{ratioellipsoid: {m: 1}}]", "scene.yaml:2:29: unknown key 'm' in ratioellipsoid"},
       {"objects: [{superhyperboloid: {clip: {min: [3, 0, 0]}}}]",
        "scene.yaml:2:43: the clip box has min > max along x"},
       {"objects: [{supertoroid: {d: -1}}]", "scene.yaml:2:29: expected a number of at least 0"},
       {"objects: [{supertoroid: {e: -1}}]", "scene.yaml:2:29: expected a number of at least 0"},
       // g_m stays below 1 / (1 - m) = 2.
       {"objects: [{ratiotoroid: {m: 0.5, d: 9}}]", "scene.yaml:2:12: the toroid has no end"}});
}

TEST(SceneSuperquadrics, DegenerateOnesAreSkipped) {
  expect_skipped({{"superellipsoid: {radii: [0, 1, 1]}",
                   "scene.yaml:2:13: warning: a radius is zero; the object is skipped"},
                  {"ratiotoroid: {e: 0}", "scene.yaml:2:13: warning: the tube has no thickness"},
                  {"superhyperboloid: {clip: {min: [2, 0, 0]}}",
                   "scene.yaml:2:13: warning: the clip box has no volume"}});
}

}  // namespace
}  // namespace oktett::scene_superquadrics_test
