/// \file Shadow catchers. What they show is compared with two pictures: with all objects, and without those
/// that throw shadows. All three have the same samples.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "core/error.h"
#include "render/film/film_state.h"
#include "tests/render/test_scenes.h"

namespace oktett::shadow_catcher_test {
namespace {

using namespace test;

/// A floor, which is object 0 and catches, and a lamp, which is object 1.
Scene floor_scene(IntegratorKind kind) {
  Scene scene = bare_scene(16);
  scene.integrator.kind = kind, scene.integrator.samples = 16, scene.integrator.depth = 3;
  scene.integrator.light_samples = kind == IntegratorKind::whitted ? 4 : 0;
  scene.camera.from = {0, 3, 3}, scene.camera.at = {0, 0.3, 0}, scene.camera.fov = 50;
  add_object(scene, PolygonShape{{{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}}},
             add_material(scene, diffuse({0.5f, 0.6f, 0.7f})));
  scene.objects[0].shadow_catcher = true;
  add_object(scene, SphereShape{{2, 4, 1}, 0.5}, add_material(scene, glowing({9, 8, 7})));
  return scene;
}

/// Adds what throws shadows.
void add_things(Scene& scene) {
  add_object(scene, SphereShape{{-0.6, 0.6, 0}, 0.6}, add_material(scene, diffuse({0.9f, 0.2f, 0.1f})));
  add_object(scene, SphereShape{{0.9, 0.5, 0.3}, 0.5}, add_material(scene, mirror()));
}

Picture shown(Scene scene, bool catches, bool things) {
  scene.objects[0].shadow_catcher = catches;
  if (things) add_things(scene);
  return run(scene).picture;
}

double mean_of_channels(const Color& c) {
  return (static_cast<double>(c.x) + static_cast<double>(c.y) + static_cast<double>(c.z)) / 3;
}

/// How much of pixels the things cover.
Picture coverage(Scene scene) {
  add_things(scene);
  scene.objects.erase(scene.objects.begin());
  return run(scene).picture;
}

TEST(ShadowCatcher, ShowsTheRatioOfTwoPictures) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path}) {
    const Scene scene = floor_scene(kind);
    const Picture caught = shown(scene, true, true), all = shown(scene, false, true),
                  empty = shown(scene, false, false), things = coverage(scene);
    std::size_t floor = 0, solid = 0, dark = 0;
    for (std::uint32_t y = 0; y < 16; ++y)
      for (std::uint32_t x = 0; x < 16; ++x) {
        const float covered = value(things, "A", x, y);
        if (covered == 1) {
          EXPECT_EQ(color(caught, x, y), color(all, x, y));
          EXPECT_EQ(value(caught, "A", x, y), 1);
          ++solid;
        }
        if (covered > 0) continue;
        const double with = mean_of_channels(color(all, x, y)),
                     without = mean_of_channels(color(empty, x, y));
        EXPECT_EQ(color(caught, x, y), (Color{0, 0, 0}));
        EXPECT_NEAR(value(caught, "A", x, y), std::max(0.0, 1 - with / without), 1e-5) << x << ' ' << y;
        for (const char* channel : {"R", "G", "B"})
          EXPECT_NEAR(value(caught, (std::string("shadow_catcher.") + channel).c_str(), x, y),
                      value(all, channel, x, y) / value(empty, channel, x, y), 1e-4);
        dark += with < 0.5 * without ? 1 : 0;
        ++floor;
      }
    EXPECT_GT(floor, 100u);
    EXPECT_GT(solid, 10u);
    EXPECT_GT(dark, 5u);
  }
}

TEST(ShadowCatcher, DarkensABackgroundThatGivesLight) {
  Scene scene = floor_scene(IntegratorKind::path);
  auto picture = std::make_shared<EnvironmentPicture>();
  picture->width = picture->height = 1, picture->pixels = {{0.5f, 1, 2}};
  scene.lights = {EnvironmentLight{picture}};
  scene.background = {0.25f, 0, 0};
  const Picture caught = shown(scene, true, true), all = shown(scene, false, true),
                empty = shown(scene, false, false), things = coverage(scene);
  std::size_t floor = 0;
  for (std::uint32_t y = 0; y < 16; ++y)
    for (std::uint32_t x = 0; x < 16; ++x) {
      EXPECT_EQ(value(caught, "A", x, y), 1);
      if (value(things, "Z", x, y) < 100) continue;
      const Color behind{0.75f, 1, 2}, with = color(all, x, y), without = color(empty, x, y);
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(color(caught, x, y)[k], behind[k] * with[k] / without[k], 1e-4) << x << ' ' << y;
      ++floor;
    }
  EXPECT_GT(floor, 100u);
}

TEST(ShadowCatcher, IsNothingWithoutOtherObjects) {
  Scene scene = floor_scene(IntegratorKind::path);
  const Picture caught = shown(scene, true, false);
  for (std::uint32_t y = 0; y < 16; ++y)
    for (std::uint32_t x = 0; x < 16; ++x) {
      EXPECT_EQ(value(caught, "A", x, y), 0);
      EXPECT_EQ(color(caught, x, y), (Color{0, 0, 0}));
    }
}

TEST(ShadowCatcher, HoldsInInstancesCombinationsAndMotion) {
  for (const int way : {0, 1, 2, 3}) {
    Scene scene = floor_scene(IntegratorKind::path);
    const Object floor = scene.objects[0];
    Scene other = scene;
    if (way == 0) {
      Object inner = floor;
      inner.shadow_catcher = false;
      other.prototypes.push_back({"floor", {inner}});
      other.objects[0] = {};
      other.objects[0].shape = InstanceShape{0}, other.objects[0].shadow_catcher = true;
    } else if (way == 1) {
      other.prototypes.push_back({"floor", {floor}});
      other.objects[0] = {};
      other.objects[0].shape = InstanceShape{0};
    }
    add_things(scene), add_things(other);
    if (way == 2) {
      // What throws shadows is a combination, or many instances.
      const Object ball = other.objects[2];
      other.objects[2].shape =
          CsgShape{CsgOp::unite, std::make_shared<const std::vector<Object>>(std::vector{ball})};
      other.prototypes.push_back({"ball", {other.objects[3]}});
      for (int i = 0; i < 70; ++i) {
        Object instance;
        instance.shape = InstanceShape{0};
        if (i == 0)
          other.objects[3] = instance;
        else
          other.objects.push_back(instance);
      }
    }
    if (way == 3) {
      Motion motion;
      motion.factors.push_back({{0, {}}, {1, Affine::translation({0, 0, 0.5})}});
      for (Scene* s : {&scene, &other})
        for (const std::size_t k : {0u, 2u}) s->objects[k].motion = std::make_shared<const Motion>(motion);
      // The prototype of a moving instance.
      other.prototypes.push_back({"ball", {other.objects[2]}});
      other.prototypes[0].objects[0].motion = nullptr;
      other.objects[2].shape = InstanceShape{0}, other.objects[2].material = kNoId;
    }
    const Picture a = run(scene).picture, b = run(other).picture;
    for (std::uint32_t y = 0; y < 16; ++y)
      for (std::uint32_t x = 0; x < 16; ++x) {
        EXPECT_NEAR(value(a, "A", x, y), value(b, "A", x, y), 2e-3) << way << ' ' << x << ' ' << y;
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(color(a, x, y)[k], color(b, x, y)[k], 0.02) << way;
      }
  }
}

TEST(ShadowCatcher, HasTheSameBitsInAFilmAndWithoutDataLayers) {
  Scene scene = floor_scene(IntegratorKind::path);
  add_things(scene);
  const Picture once = run(scene).picture;
  FilmState film(FilmShare{});
  EXPECT_TRUE(same_bytes(run(scene, [&](RenderOptions& o) { o.film = &film; }).picture, once));
  const Picture plain = run(scene, [](RenderOptions& o) { o.data_layers = false; }).picture;
  for (const char* plane : {"R", "G", "B", "A"})
    for (std::uint32_t y = 0; y < 16; ++y)
      for (std::uint32_t x = 0; x < 16; ++x) EXPECT_EQ(value(plain, plane, x, y), value(once, plane, x, y));
}

TEST(ShadowCatcher, MeansNothingInPicturesWithoutBounces) {
  for (const IntegratorKind kind : {IntegratorKind::ao, IntegratorKind::normal})
    EXPECT_TRUE(same_bytes(shown(floor_scene(kind), true, true), shown(floor_scene(kind), false, true)));
}

TEST(ShadowCatcher, RefusesPhotonsAndLightGroups) {
  const auto error_of = [](const Scene& scene) -> std::string {
    try {
      run(scene);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  Scene scene = floor_scene(IntegratorKind::path);
  scene.integrator.caustics.photons = 100;
  EXPECT_EQ(error_of(scene), "photons of 'caustics' do not know shadow catchers");
  scene.integrator.caustics.photons = 0;
  scene.materials[1].light_group = "key";
  EXPECT_EQ(error_of(scene), "light groups do not know shadow catchers");
}

}  // namespace
}  // namespace oktett::shadow_catcher_test
