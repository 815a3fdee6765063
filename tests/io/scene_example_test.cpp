#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <vector>

#include "io/image/texture.h"
#include "render/picture/render.h"
#include "tests/io/scene_test_support.h"
#include "tests/render/test_scenes.h"

namespace oktett::scene_example_test {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(OKTETT_SOURCE_DIR) / "scenes";
const char* const kBunny = "/usr/share/glmark2/models/bunny.obj";

std::string scene_path(const char* name) { return (kScenes / name).string(); }

/// The mesh is not part of the project.
bool lacks_bunny(const std::filesystem::path& scene) {
  return (scene.stem() == "bunny" || scene.stem() == "still_life") && !std::filesystem::exists(kBunny);
}

TEST(SceneExample, EveryExampleLoadsWithoutWarnings) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kScenes)) {
    if (entry.path().extension() != ".yaml") continue;
    if (lacks_bunny(entry.path())) continue;
    SCOPED_TRACE(entry.path().string());
    const Scene scene = load_scene(entry.path().string());
    for (const Warning& warning : scene.warnings) ADD_FAILURE() << to_string(warning);
    ++count;
  }
  EXPECT_GT(count, 30);
}

TEST(SceneExample, ShapesShowsEveryShape) {
  const Scene scene = load_scene(scene_path("shapes.yaml"));
  std::vector<bool> seen(std::variant_size_v<Shape::variant>);
  for (const Object& object : scene.objects) seen[object.shape.index()] = true;
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_TRUE(seen[i]) << "alternative " << i << " of Shape";
}

/// A small picture with all its layers.
Picture small_picture(Scene scene, Isa isa, unsigned threads) {
  scene.film.height = std::max(1u, 40 * scene.film.height / scene.film.width), scene.film.width = 40;
  scene.integrator.samples = std::min(scene.integrator.samples, 4u);
  const ImageTextures textures(scene.textures);
  RenderOptions options;
  options.isa = isa, options.threads = threads, options.tile_size = 16;
  options.textures = &textures;
  RenderResult result = render(std::move(scene), options);
  EXPECT_EQ(result.report.bad_samples, 0u);
  return std::move(result.picture);
}

/// Only the depth may be infinite, where there is nothing.
void expect_finite(const Picture& picture) {
  for (const PicturePlane& plane : picture.planes)
    for (const float value : plane.values) {
      const bool nothing = plane.name == "Z" && value == std::numeric_limits<float>::infinity();
      ASSERT_TRUE(std::isfinite(value) || nothing) << plane.name;
    }
}

TEST(SceneExample, EveryPictureHasTheSameBitsForAllSetsAndThreads) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kScenes)) {
    if (entry.path().extension() != ".yaml") continue;
    if (lacks_bunny(entry.path())) continue;
    SCOPED_TRACE(entry.path().string());
    const Scene scene = load_scene(entry.path().string());
    const Picture expected = small_picture(scene, Isa::scalar, 1);
    EXPECT_GE(expected.planes.size(), 15u);
    expect_finite(expected);
    for (const Isa isa : available_isas())
      EXPECT_TRUE(test::same_bytes(small_picture(scene, isa, 2), expected)) << to_string(isa);
    ++count;
  }
  EXPECT_GT(count, 30);
}

/// The bunny stands on the ground: its lowest vertex touches y = 0.
TEST(SceneExample, TheBunnyStandsOnTheGround) {
  if (!std::filesystem::exists(kBunny)) GTEST_SKIP() << "needs " << kBunny;
  for (const char* name : {"bunny.yaml", "still_life.yaml"}) {
    int meshes = 0;
    for (const Object& object : load_scene(scene_path(name)).objects) {
      const auto* mesh = std::get_if<MeshShape>(&object.shape);
      if (!mesh) continue;
      double lowest = 1e9;
      for (const Vec3f& p : mesh->mesh->positions)
        lowest = std::min(lowest, object.transform.point(Vec3d(p)).y);
      EXPECT_NEAR(lowest, 0, 1e-6) << name;
      ++meshes;
    }
    EXPECT_EQ(meshes, 1) << name;
  }
}

/// The glTF file shows one mesh for each material, whoever shares it, and gives the camera and a lamp.
TEST(SceneExample, PawnsOfOneMaterialAreInstancesOfOneMesh) {
  const Scene scene = load_scene(scene_path("pawns.yaml"));
  std::map<std::uint32_t, int> instances;
  for (const Object& object : scene.objects)
    if (const auto* instance = std::get_if<InstanceShape>(&object.shape)) ++instances[instance->prototype];
  EXPECT_EQ(instances.size(), 2u);
  for (const auto& [prototype, count] : instances) EXPECT_EQ(count, 3) << prototype;
  EXPECT_NEAR(scene.camera.from.z, 6.2, 1e-6);
  EXPECT_EQ(scene.lights.size(), 1u);
}

TEST(SceneExample, TheBunnyCanBeReplaced) {
  for (const char* name : {"bunny.yaml", "still_life.yaml"})
    EXPECT_TRUE(
        load_scene(scene_path(name), {{"bunny", scene_path("assets/tetrahedron.obj")}}).warnings.empty())
        << name;
}

}  // namespace
}  // namespace oktett::scene_example_test
