#include <gtest/gtest.h>

#include "tests/io/scene_test_support.h"

namespace oktett {
namespace {

using test::expect_starts;
using test::SceneFiles;

template <class T>
const T& form_of(const Scene& scene, std::size_t i) {
  return std::get<T>(test::shape_of<ExactShape>(scene, i).form);
}

TEST(SceneFractals, HaveNaturalDefaults) {
  const Scene scene = SceneFiles().load_v1("objects: [{sphereflake: }, {menger: }]\n");
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(form_of<SphereflakeShape>(scene, 0).depth, 4u);
  EXPECT_EQ(form_of<SphereflakeShape>(scene, 0).ratio, 1.0 / 3);
  EXPECT_EQ(form_of<MengerShape>(scene, 1).depth, 4u);
}

TEST(SceneFractals, ReadAllParameters) {
  const Scene scene =
      SceneFiles().load_v1("objects: [{sphereflake: {depth: 12, ratio: 0.25}}, {menger: {depth: 10}}]\n");
  EXPECT_EQ(form_of<SphereflakeShape>(scene, 0).depth, 12u);
  EXPECT_EQ(form_of<SphereflakeShape>(scene, 0).ratio, 0.25);
  EXPECT_EQ(form_of<MengerShape>(scene, 1).depth, 10u);
}

TEST(SceneFractals, ErrorsHaveTheirPlace) {
  const struct {
    std::string text, error;
  } kCases[] = {
      {"objects: [{sphereflake: {depth: 25}}]", "scene.yaml:2:33: expected an integer from 0 to 24"},
      {"objects: [{sphereflake: {depth: -1}}]", "scene.yaml:2:33: expected an integer from 0 to 24"},
      {"objects: [{sphereflake: {depth: 2.5}}]", "scene.yaml:2:33: expected an integer from 0 to 24"},
      {"objects: [{sphereflake: {ratio: 0}}]", "scene.yaml:2:33: expected a number greater than 0"},
      {"objects: [{sphereflake: {ratio: 0.6}}]", "scene.yaml:2:33: expected a number greater than 0"},
      {"objects: [{sphereflake: {radius: 1}}]", "scene.yaml:2:26: unknown key 'radius' in sphereflake"},
      {"objects: [{menger: {depth: 17}}]", "scene.yaml:2:28: expected an integer from 0 to 16"},
      {"objects: [{menger: {normals: central}}]", "scene.yaml:2:21: unknown key 'normals' in menger"},
      {"objects: [{menger: 3}]", "scene.yaml:2:20: "},
  };
  SceneFiles files;
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.text);
    expect_starts(files.error_v1(c.text), c.error);
  }
}

}  // namespace
}  // namespace oktett
