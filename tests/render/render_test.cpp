#include "render/picture/render.h"

#include <gtest/gtest.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <mutex>
#include <vector>

#include "core/error.h"
#include "tests/render/test_scenes.h"

namespace oktett::render_test {
namespace {

using namespace test;

/// A scene with a mesh, closed-form shapes, instances, a mirror, glass and tinted shadows.
Scene busy_scene(IntegratorKind kind) {
  Scene scene = bare_scene();
  scene.film.width = 53, scene.film.height = 37;
  scene.integrator = {kind, 5, 4, 3, 0};
  scene.background = {0.1f, 0.2f, 0.3f};
  scene.ambient_light = {1, 1, 1};
  scene.camera.from = {2, 2, 6};
  scene.lights = {PointLight{{4, 6, 5}, {20, 20, 20}, true},
                  DirectionalLight{{-1, -2, -1}, {0.5f, 0.5f, 0.4f}}};
  Material shiny = diffuse({0.7f, 0.4f, 0.2f});
  shiny.specular = 0.5f, shiny.phong = 33.3f, shiny.reflection = 0.3f, shiny.ambient = 0.1f;
  const std::uint32_t a = add_material(scene, shiny);
  Material clear = glass(1.5f);
  clear.color = {0.9f, 1, 0.9f}, clear.specular = 0.5f, clear.transparency = 0.9f;
  const std::uint32_t b = add_material(scene, clear);
  add_object(scene, PlaneShape{{0, 1, 0}, -1}, add_material(scene, diffuse({0.5f, 0.5f, 0.5f})));
  add_object(scene, SphereShape{{-1.2, 0, 0}, 1}, b);
  add_object(scene, MeshShape{sphere_mesh(10), {}, true, TriangleTest::watertight}, a,
             Affine::translation({1.2, 0, 0}));
  Object ball;
  ball.shape = SphereShape{{0, 0, 0}, 0.4};
  scene.prototypes.push_back({"ball", {ball}});
  for (int i = -2; i <= 2; ++i)
    add_object(scene, InstanceShape{0}, a, Affine::translation({0.9 * i, -0.6, 1.8}));
  return scene;
}

constexpr IntegratorKind kAllKinds[] = {IntegratorKind::whitted, IntegratorKind::path, IntegratorKind::ao,
                                        IntegratorKind::normal, IntegratorKind::depth};

/// Without data layers, hits are shaded in blocks and without uv. The colours must be the same.
void expect_same_colours_without_layers(const Scene& scene) {
  const Picture with = run(scene).picture;
  for (const Isa isa : available_isas()) {
    const Picture without = run(scene, [&](RenderOptions& o) { o.data_layers = false, o.isa = isa; }).picture;
    ASSERT_EQ(without.planes.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t i = 0; i < with.planes[k].values.size(); ++i)
        ASSERT_EQ(std::bit_cast<std::uint32_t>(with.planes[k].values[i]),
                  std::bit_cast<std::uint32_t>(without.planes[k].values[i]))
            << to_string(isa) << ", plane " << k << ", pixel " << i;
  }
}

TEST(Render, ColoursAreTheSameWithoutDataLayers) {
  for (int n = 0; n <= static_cast<int>(std::size(kAllKinds)); ++n) {
    const bool mirrors_only = n == static_cast<int>(std::size(kAllKinds));
    Scene scene = busy_scene(mirrors_only ? IntegratorKind::whitted : kAllKinds[n]);
    // Without glass, mirrored rays leave whole blocks in lanes. The normals of the mesh are bent enough for
    // mirrored rays that have to be folded back above its faces.
    if (mirrors_only)
      for (Material& m : scene.materials) m.transparency = 0, m.reflection = 0.8f;
    Material checked = diffuse({1, 1, 1});
    scene.textures.push_back({"no such file"});
    checked.color_texture = 0;
    add_object(scene, ExactShape{TorusShape{0.8, 0.3}}, add_material(scene, checked),
               Affine::translation({0, 1, 0}));
    add_object(scene, ExactShape{TorusShape{0.8, 0.3}}, 0, Affine::translation({0, 1, -2}));
    scene.lights.push_back(PointLight{{-3, 0.5, 0}, {1, 1, 1}});
    // Phong's highlight on the far side of a surface that the light is just behind.
    scene.lights.push_back(DirectionalLight{{0, 1e-3, -1}, {1, 1, 1}});
    expect_same_colours_without_layers(scene);
  }
}

/// Glass of many kinds around a mesh whose normals are bent enough for refracted rays that would lead above
/// its faces, so deep that samples reach the limit of their rays.
TEST(Render, GlassIsTheSameWithoutDataLayers) {
  for (const std::uint32_t depth : {0u, 1u, 4u, 12u}) {
    Scene scene = busy_scene(IntegratorKind::whitted);
    scene.integrator.depth = depth;
    const float iors[] = {0.6f, 1, 1.5f, 2.4f};
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
      Material& m = scene.materials[i];
      m.transparency = 0.9f, m.ior = iors[i % 4], m.reflection = i % 2 == 0 ? 0.0f : 0.3f;
    }
    for (const float ior : iors)
      add_object(scene, SphereShape{{2 * ior - 3, -0.2, 1}, 0.5}, add_material(scene, glass(ior)));
    add_object(scene, MeshShape{sphere_mesh(4), {}, true, TriangleTest::watertight}, 0,
               Affine::translation({0.5, 1.2, 2}));
    add_object(scene, BoxShape{{-1, 1, -1}, {1, 1.5, 1}}, add_material(scene, glass(1.5f)));
    expect_same_colours_without_layers(scene);
  }
}

// More threads than an arena of TBB can hold would end the process.
TEST(Render, ThreadsHaveALimit) {
  EXPECT_THROW(run(busy_scene(kAllKinds[0]), [](RenderOptions& o) { o.threads = kMostThreads + 1; }), Error);
}

TEST(Render, PictureDependsNeitherOnThreadsNorTilesNorInstructionSet) {
  for (const IntegratorKind kind : kAllKinds) {
    const Scene scene = busy_scene(kind);
    const Picture reference = run(scene).picture;
    for (const unsigned threads : {1u, 2u, 7u})
      EXPECT_TRUE(same_bytes(reference, run(scene, [&](RenderOptions& o) { o.threads = threads; }).picture))
          << threads;
    for (const std::uint32_t tile : {1u, 3u, 8u, 64u})
      EXPECT_TRUE(same_bytes(reference, run(scene, [&](RenderOptions& o) { o.tile_size = tile; }).picture))
          << tile;
    for (const Isa isa : available_isas())
      EXPECT_TRUE(same_bytes(reference, run(scene, [&](RenderOptions& o) { o.isa = isa; }).picture))
          << to_string(isa);
  }
}

// A bounce of a tile may have more rays than one call traces on one thread. While a thread waits for the
// others, it must not begin another tile.
TEST(Render, BouncesOfManyRaysDependOnNoOtherTile) {
  Scene scene = bare_scene(512);
  scene.camera.from = {0, 0, 10};
  scene.lights = {PointLight{{3, 4, 5}}};
  scene.integrator.depth = 4;
  Material clear = glass(1.5f);
  clear.reflection = 0.3f;
  const std::uint32_t pane = add_material(scene, clear);
  for (int i = 0; i < 400; ++i)
    add_object(scene, SphereShape{{0.45 * (i % 20 - 9.5), 0.45 * (i / 20 - 9.5), 0.01 * (i % 7)}, 0.3}, pane);
  const auto at = [&](unsigned threads) {
    return run(scene, [&](RenderOptions& o) { o.tile_size = 64, o.threads = threads, o.data_layers = false; })
        .picture;
  };
  const Picture alone = at(1);
  for (int i = 0; i < 6; ++i) EXPECT_TRUE(same_bytes(alone, at(4))) << i;
}

TEST(Render, ManySamplesAreSplitIntoWavesWithoutATrace) {
  Scene scene = busy_scene(IntegratorKind::path);
  scene.film.width = 3, scene.film.height = 2;
  scene.integrator.samples = 5000;
  const Picture reference = run(scene).picture;
  EXPECT_TRUE(same_bytes(reference, run(scene, [](RenderOptions& o) { o.tile_size = 1; }).picture));
}

TEST(Render, CropIsPartOfTheFullPicture) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path}) {
    Scene scene = busy_scene(kind);
    const Picture full = run(scene).picture;
    scene.film.crop[0] = 0.3, scene.film.crop[1] = 0.8, scene.film.crop[2] = 0.25, scene.film.crop[3] = 0.6;
    const Picture part = run(scene).picture;
    EXPECT_EQ(part.x, 16u);
    EXPECT_EQ(part.y, 10u);
    EXPECT_EQ(part.width, 27u);
    EXPECT_EQ(part.full_width, 53u);
    for (std::uint32_t y = 0; y < part.height; ++y)
      for (std::uint32_t x = 0; x < part.width; ++x) {
        EXPECT_EQ(color(part, x, y), color(full, part.x + x, part.y + y));
        EXPECT_EQ(value(part, "Z", x, y), value(full, "Z", part.x + x, part.y + y));
        EXPECT_EQ(id(part, "primID.I", x, y), id(full, "primID.I", part.x + x, part.y + y));
      }
  }
}

TEST(Render, SeedChangesTheNoiseOnly) {
  Scene scene = busy_scene(IntegratorKind::path);
  const Picture a = run(scene).picture;
  scene.integrator.seed = 4;
  const Picture b = run(scene).picture;
  EXPECT_FALSE(same_bytes(a, b));
  double sum_a = 0, sum_b = 0;
  for (const float v : a.find("G")->values) sum_a += static_cast<double>(v);
  for (const float v : b.find("G")->values) sum_b += static_cast<double>(v);
  EXPECT_NEAR(sum_a / sum_b, 1, 0.1);
}

TEST(Render, EmptySceneShowsTheBackground) {
  for (const IntegratorKind kind : kAllKinds) {
    Scene scene;
    scene.film.width = 20, scene.film.height = 10;
    scene.background = {0.25f, 0.5f, 1};
    scene.integrator.kind = kind;
    const RenderResult r = run(scene);
    for (std::uint32_t y = 0; y < 10; ++y)
      for (std::uint32_t x = 0; x < 20; ++x) ASSERT_EQ(color(r.picture, x, y), scene.background);
    EXPECT_EQ(r.report.camera_rays, 800u);
    EXPECT_EQ(r.report.shadow_rays, 0u);
    EXPECT_EQ(r.report.primitives, 0u);
  }
}

TEST(Render, MissingCameraAndLightsAreFilledIn) {
  Scene scene;
  scene.film.width = 40, scene.film.height = 30;
  add_object(scene, SphereShape{{100, 20, -7}, 3}, kNoId);
  add_object(scene, PlaneShape{{0, 1, 0}, -1000}, kNoId);
  const RenderResult r = run(scene);
  EXPECT_EQ(r.scene.lights.size(), 2u);
  EXPECT_NEAR(length(r.scene.camera.at - Vec3d{100, 20, -7}), 0, 1e-4);
  EXPECT_EQ(id(r.picture, "geomID.I", 20, 15), 0u);
  EXPECT_GT(color(r.picture, 20, 15).x, 0.3f);
  for (std::uint32_t x = 0; x < 40; ++x) EXPECT_NE(id(r.picture, "geomID.I", x, 0), 0u);
}

TEST(Render, StopLeavesTheRestBlackAndTransparent) {
  const Scene scene = busy_scene(IntegratorKind::whitted);
  std::atomic<bool> stop{true};
  const RenderResult none = run(scene, [&](RenderOptions& o) { o.stop = &stop; });
  EXPECT_TRUE(none.report.stopped);
  for (const char* plane : {"R", "A", "N.X"})
    for (const float v : none.picture.find(plane)->values) ASSERT_EQ(v, 0);

  stop = false;
  const RenderResult some = run(scene, [&](RenderOptions& o) {
    o.stop = &stop, o.threads = 1, o.tile_size = 8;
    o.tile_finished = [&](const Picture&, const FinishedTile&) { stop = true; };
  });
  EXPECT_TRUE(some.report.stopped);
  EXPECT_EQ(some.report.camera_rays, 8u * 8 * 5);
  const Picture full = run(scene).picture;
  int same = 0;
  for (std::uint32_t y = 0; y < full.height; ++y)
    for (std::uint32_t x = 0; x < full.width; ++x)
      if (value(some.picture, "A", x, y) > 0) {
        ++same;
        ASSERT_EQ(color(some.picture, x, y), color(full, x, y));
      }
  EXPECT_EQ(same, 64);
  EXPECT_FALSE(run(scene).report.stopped);
}

TEST(Render, CallbacksSeeEachTileOnceAndOneAtATime) {
  const Scene scene = busy_scene(IntegratorKind::whitted);
  std::vector<int> finished(53 * 37);
  std::atomic<int> inside{0};
  std::uint64_t last = 0;
  const RenderResult r = run(scene, [&](RenderOptions& o) {
    o.threads = 4, o.tile_size = 5;
    o.tile_finished = [&](const Picture& p, const FinishedTile& t) {
      EXPECT_EQ(++inside, 1);
      for (std::uint32_t y = t.y; y < t.y + t.height; ++y)
        for (std::uint32_t x = t.x; x < t.x + t.width; ++x) {
          ++finished[y * p.width + x];
          EXPECT_EQ(value(p, "A", x, y), 1);
        }
      --inside;
    };
    o.progress = [&](const RenderProgress& progress) {
      EXPECT_GE(progress.pixels_done, last);
      last = progress.pixels_done;
      EXPECT_EQ(progress.pixels_total, 53u * 37);
    };
  });
  for (const int n : finished) EXPECT_EQ(n, 1);
  EXPECT_EQ(last, 53u * 37);
  EXPECT_EQ(r.report.camera_rays, 53u * 37 * 5);
  EXPECT_GT(r.report.reflected_rays, 0u);
  EXPECT_GT(r.report.refracted_rays, 0u);
  EXPECT_GT(r.report.shadow_rays, 0u);
}

TEST(Render, NumbersThatAreNoneAreCountedAndLeftOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const auto bad_samples = [](const Scene& scene) {
    const RenderResult r = run(scene);
    for (const char* plane : {"R", "G", "B", "A", "Variance.R"})
      for (const float v : r.picture.find(plane)->values) EXPECT_TRUE(std::isfinite(v));
    return r.report.bad_samples;
  };
  Scene scene = bare_scene(8);
  add_object(scene, PlaneShape{{0, 0, 1}, 0}, add_material(scene, diffuse({1, 1, 1})));
  scene.lights = {PointLight{{0, 0, 3}, {1, 1, 1}, false}};
  EXPECT_EQ(bad_samples(scene), 0u);
  for (const float bad : {nan, inf}) {
    Scene s = scene;
    s.materials[0].color.y = bad;
    EXPECT_EQ(bad_samples(s), 64u);
    s = scene;
    s.lights = {PointLight{{0, 0, 3}, {1, bad, 1}, false}};
    EXPECT_EQ(bad_samples(s), 64u);
    s = scene;
    s.background = {bad, 0, 0};
    s.objects.clear();
    EXPECT_EQ(bad_samples(s), 64u);
  }
  Scene s = scene;
  s.lights = {PointLight{{static_cast<double>(nan), 0, 3}, {1, 1, 1}, false}};
  EXPECT_EQ(bad_samples(s), 64u);
  s = scene;
  s.materials[0].reflection = nan;
  EXPECT_EQ(bad_samples(s), 64u);
}

// The samples of this pixel fill several wavefronts, some of which meet nothing.
TEST(Render, APixelOfManyWavesCountsThoseThatMeetNothing) {
  Scene scene = bare_scene(1);
  scene.integrator.samples = 65536;
  scene.camera.fov = 60, scene.camera.from = {0, 0, 10};
  // A square in the corner of the view: 0.1 of the width times 0.2 of the height.
  const double edge = 10 * std::tan(std::numbers::pi / 6);
  PolygonShape square;
  square.vertices = {
      {-edge, -edge, 0}, {-0.8 * edge, -edge, 0}, {-0.8 * edge, -0.6 * edge, 0}, {-edge, -0.6 * edge, 0}};
  add_object(scene, square, add_material(scene, glowing({1, 1, 1})));
  const Picture picture = run(scene).picture;
  EXPECT_NEAR(picture.find("A")->values[0], 0.02, 2e-4);
  EXPECT_NEAR(picture.find("R")->values[0], 0.02, 2e-4);
}

}  // namespace
}  // namespace oktett::render_test
