#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

#include "tests/io/scene_test_support.h"

namespace oktett {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(OKTETT_SOURCE_DIR) / "scenes";
const char* const kBunny = "/usr/share/glmark2/models/bunny.obj";

std::string scene_path(const char* name) { return (kScenes / name).string(); }

TEST(SceneExample, EveryExampleLoadsWithoutWarnings) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kScenes)) {
    if (entry.path().extension() != ".yaml") continue;
    if (entry.path().filename() == "bunny.yaml" && !std::filesystem::exists(kBunny)) continue;
    SCOPED_TRACE(entry.path().string());
    const Scene scene = load_scene(entry.path().string());
    for (const Warning& warning : scene.warnings) ADD_FAILURE() << to_string(warning);
    ++count;
  }
  EXPECT_GE(count, 4);
}

TEST(SceneExample, ShapesShowsEveryShape) {
  const Scene scene = load_scene(scene_path("shapes.yaml"));
  std::vector<bool> seen(std::variant_size_v<Shape>);
  for (const Object& object : scene.objects) seen[object.shape.index()] = true;
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_TRUE(seen[i]) << "alternative " << i << " of Shape";
}

/// The bunny stands on the ground: its lowest vertex touches y = 0.
TEST(SceneExample, TheBunnyStandsOnTheGround) {
  if (!std::filesystem::exists(kBunny)) GTEST_SKIP() << "needs " << kBunny;
  const Scene scene = load_scene(scene_path("bunny.yaml"));
  for (const Object& object : scene.objects) {
    const auto* mesh = std::get_if<MeshShape>(&object.shape);
    if (!mesh) continue;
    double lowest = 1e9;
    for (const Vec3f& p : mesh->mesh->positions)
      lowest = std::min(lowest, object.transform.point(Vec3d(p)).y);
    EXPECT_NEAR(lowest, 0, 1e-6);
    return;
  }
  FAIL() << "there is no mesh";
}

TEST(SceneExample, TheBunnyCanBeReplaced) {
  const Scene scene = load_scene(scene_path("bunny.yaml"), {{"bunny", scene_path("assets/tetrahedron.obj")}});
  EXPECT_TRUE(scene.warnings.empty());
}

}  // namespace
}  // namespace oktett
