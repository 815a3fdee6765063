#include <gtest/gtest.h>

#include "tests/io/scene_test_support.h"

namespace oktett::scene_fractals_test {
namespace {

using test::expect_errors;
using test::expect_skipped;
using test::SceneFiles;

template <class T>
const T& form_of(const Scene& scene, std::size_t i) {
  return std::get<T>(test::shape_of<ExactShape>(scene, i).form);
}

TEST(SceneFractals, HaveNaturalDefaults) {
  const Scene scene = SceneFiles().load_v1(
      "objects: [{sphereflake: }, {menger: }, {julia: }, {terrain: }, {ifs: {maps: [{scale: 0.5}]}}]\n");
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(form_of<SphereflakeShape>(scene, 0).depth, 4u);
  EXPECT_EQ(form_of<SphereflakeShape>(scene, 0).ratio, 1.0 / 3);
  EXPECT_EQ(form_of<MengerShape>(scene, 1).depth, 4u);
  EXPECT_EQ(form_of<JuliaShape>(scene, 2).iterations, 10u);
  EXPECT_EQ(form_of<TerrainShape>(scene, 3).depth, 10u);
  EXPECT_EQ(form_of<IfsShape>(scene, 4).depth, 8u);
  EXPECT_EQ(form_of<IfsShape>(scene, 4).base, IfsShape::Base::ball);
}

TEST(SceneFractals, ReadAllParameters) {
  const Scene scene =
      SceneFiles().load_v1("objects: [{sphereflake: {depth: 12, ratio: 0.25}}, {menger: {depth: 10}}]\n");
  EXPECT_EQ(form_of<SphereflakeShape>(scene, 0).depth, 12u);
  EXPECT_EQ(form_of<SphereflakeShape>(scene, 0).ratio, 0.25);
  EXPECT_EQ(form_of<MengerShape>(scene, 1).depth, 10u);
  const Scene more = SceneFiles().load_v1(
      "objects:\n"
      "  - ifs: {maps: [{scale: 0.5}, [{scale: 0.25}, {translate: [1, 2, 3]}]], depth: 5, base: box, least: "
      "0.01, "
      "every_level: true}\n"
      "  - julia: {c: [-0.5, 0.5, 0.25, 0], slice: 0.125, iterations: 7, normals: central}\n"
      "  - terrain: {depth: 20, seed: 7, height: 2, roughness: 0.75, base: -3}\n");
  EXPECT_TRUE(more.warnings.empty());
  const auto& ifs = form_of<IfsShape>(more, 0);
  ASSERT_EQ(ifs.maps.size(), 2u);
  EXPECT_EQ(ifs.maps[1].point({4, 4, 4}), (Vec3d{2, 3, 4}));
  EXPECT_TRUE(ifs.depth == 5 && ifs.base == IfsShape::Base::box && ifs.least == 0.01 && ifs.every_level);
  const auto& julia = form_of<JuliaShape>(more, 1);
  EXPECT_TRUE(julia.c[0] == -0.5 && julia.c[2] == 0.25 && julia.slice == 0.125 && julia.iterations == 7);
  EXPECT_EQ(test::shape_of<ExactShape>(more, 1).normals, NormalMethod::central);
  const auto& land = form_of<TerrainShape>(more, 2);
  EXPECT_TRUE(land.depth == 20 && land.seed == 7 && land.height == 2 && land.roughness == 0.75 &&
              land.base == -3);
}

TEST(SceneFractals, ErrorsHaveTheirPlace) {
  expect_errors(
      {{"objects: [{sphereflake: {depth: 25}}]", "scene.yaml:2:33: expected a whole number from 0 to 24"},
       {"objects: [{sphereflake: {depth: -1}}]", "scene.yaml:2:33: expected a whole number from 0 to 24"},
       {"objects: [{sphereflake: {depth: 2.5}}]", "scene.yaml:2:33: expected a whole number from 0 to 24"},
       {"objects: [{sphereflake: {ratio: 0}}]", "scene.yaml:2:33: expected a number greater than 0"},
       {"objects: [{sphereflake: {ratio: 0.6}}]", "scene.yaml:2:33: expected a number greater than 0"},
       {"objects: [{sphereflake: {radius: 1}}]", "scene.yaml:2:26: unknown key 'radius' in sphereflake"},
       {"objects: [{menger: {depth: 17}}]", "scene.yaml:2:28: expected a whole number from 0 to 16"},
       {"objects: [{menger: {normals: central}}]", "scene.yaml:2:21: unknown key 'normals' in menger"},
       {"objects: [{ifs: {depth: 2}}]", "scene.yaml:2:17: ifs needs 'maps'"},
       {"objects: [{ifs: {maps: []}}]", "scene.yaml:2:24: expected 1 to 64 maps, found 0"},
       {"objects: [{ifs: {maps: [{scale: 0.5}, {scale: [0.5, 1.5, 0.5]}]}}]",
        "scene.yaml:2:39: expected a contraction, found a map that makes lengths up to 1.5 times as long"},
       {"objects: [{ifs: {maps: [{scale: [0.5, 0, 0.5]}]}}]",
        "scene.yaml:2:25: expected a map with an inverse"},
       {"objects: [{ifs: {maps: [{scale: 0.5}], base: cone}}]", "scene.yaml:2:46: "},
       {"objects: [{ifs: {maps: [{scale: 0.5}], depth: 33}}]",
        "scene.yaml:2:47: expected a whole number from 0 to 32"},
       {"objects: [{ifs: {maps: [{scale: 0.5}], least: 2}}]",
        "scene.yaml:2:47: expected a number from 0 to 1"},
       {"objects: [{julia: {c: [2, 1, 0, 0]}}]", "scene.yaml:2:23: expected |c| of at most 2, found 2.23607"},
       {"objects: [{julia: {c: [2, 1, 0]}}]", "scene.yaml:2:23: expected 4 numbers"},
       {"objects: [{julia: {iterations: 0}}]", "scene.yaml:2:32: expected a whole number from 1 to 24"},
       {"objects: [{terrain: {depth: 25}}]", "scene.yaml:2:29: expected a whole number from 0 to 24"},
       {"objects: [{terrain: {roughness: 1}}]", "scene.yaml:2:33: expected a number"},
       {"objects: [{terrain: {height: -1}}]", "scene.yaml:2:30: expected a number of at least 0"},
       {"objects: [{menger: 3}]", "scene.yaml:2:20: expected a map for menger"}});
}

TEST(SceneFractals, EmptyOnesAreSkipped) {
  expect_skipped({{"julia: {slice: 9}", "scene.yaml:2:13: warning: nothing of the set is in this slice"},
                  {"terrain: {base: 9}", "scene.yaml:2:13: warning: the landscape lies below its base"}});
}

}  // namespace
}  // namespace oktett::scene_fractals_test
