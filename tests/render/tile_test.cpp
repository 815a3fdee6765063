#include "render/film/tile.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "render/film/film.h"
#include "render/geometry.h"
#include "tests/render/test_scenes.h"

namespace oktett::tile_test {
namespace {

using namespace test;

TEST(Tile, TilesCoverThePictureOnce) {
  for (const std::uint32_t size : {1u, 5u, 16u, 1000u}) {
    std::vector<int> seen(50 * 37);
    for (const FinishedTile& t : cut_tiles(50, 37, size))
      for (std::uint32_t y = t.y; y < t.y + t.height; ++y)
        for (std::uint32_t x = t.x; x < t.x + t.width; ++x) ++seen[y * 50 + x];
    for (const int n : seen) ASSERT_EQ(n, 1) << size;
  }
}

/// A few bodies, one of them of glass, over a floor.
Scene small_scene() {
  Scene scene = bare_scene();
  scene.film.width = 40, scene.film.height = 30;
  scene.integrator.samples = 4;
  scene.background = {0.2f, 0.3f, 0.4f};
  scene.camera.from = {1, 2, 5};
  scene.lights = {PointLight{{3, 4, 5}, {1, 1, 1}, false}};
  Material m = diffuse({0.8f, 0.5f, 0.3f});
  m.reflection = 0.3f, m.specular = 0.4f;
  add_object(scene, SphereShape{{-1, 0, 0}, 1}, add_material(scene, m));
  add_object(scene, SphereShape{{1.2, 0, 0}, 1}, add_material(scene, glass(1.5f)));
  add_object(scene, PlaneShape{{0, 1, 0}, -1}, 0);
  return scene;
}

// Tiles share nothing but what none of them writes. Plain threads serve here because thread sanitizers know
// them.
TEST(Tile, TilesNeedNoOrderAmongThreads) {
  const Scene scene = small_scene();
  BuildOptions build;
  build.parallel = false;
  const World world = build_world(scene, build);
  const SceneLights lights(scene, world);
  const RenderContext context = make_context(scene, world, lights, nullptr, default_isa());
  const auto with_threads = [&](int count) {
    Picture picture = make_picture(format_of(context));
    const std::vector<FinishedTile> tiles = cut_tiles(picture.width, picture.height, 7);
    std::atomic<std::size_t> next{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < count; ++i)
      threads.emplace_back([&] {
        TileWorkspace work;
        for (std::size_t t; (t = next++) < tiles.size();) render_tile(context, tiles[t], picture, work);
      });
    for (std::thread& thread : threads) thread.join();
    return picture;
  };
  EXPECT_TRUE(same_bytes(with_threads(1), with_threads(4)));
}

}  // namespace
}  // namespace oktett::tile_test
