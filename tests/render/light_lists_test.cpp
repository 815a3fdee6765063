/// \file Lights that are for some objects only. The parts of a picture in which one light is for some
/// objects, and for all others, add up to that of the light for all.

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "tests/render/test_scenes.h"

namespace oktett::light_lists_test {
namespace {

using namespace test;

/// A floor and a ball, seen from above: objects 0 and 1.
Scene things(IntegratorKind kind, std::uint32_t depth) {
  Scene scene = bare_scene(12);
  scene.integrator.kind = kind, scene.integrator.samples = 8, scene.integrator.depth = depth;
  scene.camera.from = {0, 3, 5}, scene.camera.at = {0, 0.3, 0}, scene.camera.fov = 40;
  add_object(scene, PolygonShape{{{-4, 0, -4}, {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}}},
             add_material(scene, diffuse({0.5f, 0.6f, 0.7f})));
  add_object(scene, SphereShape{{0, 0.6, 0}, 0.6}, add_material(scene, diffuse({0.8f, 0.5f, 0.3f})));
  return scene;
}

EnvironmentLight even_environment(const Color& radiance) {
  auto picture = std::make_shared<EnvironmentPicture>();
  picture->width = picture->height = 1, picture->pixels = {radiance};
  return EnvironmentLight{picture};
}

struct Lamp {
  const char* name;
  /// Adds the light, with `list` as its list.
  std::function<void(Scene&, std::uint32_t list)> add;
  bool whitted;
};

void add_light(Scene& scene, Light light, std::uint32_t list) {
  scene.lights.push_back(std::move(light));
  scene.light_traits.resize(scene.lights.size());
  scene.light_traits.back().list = list;
}

void add_lamp(Scene& scene, Shape shape, std::uint32_t list) {
  Material m = glowing({3, 2, 1});
  add_object(scene, std::move(shape), add_material(scene, m));
  scene.objects.back().light_list = list;
  // Seen it would be a part of each picture.
  scene.objects.back().visible_to = static_cast<std::uint8_t>(kAllRays & ~bit_of(RayKind::camera));
}

const Lamp kLamps[] = {
    {"point",
     [](Scene& s, std::uint32_t list) {
       add_light(s, PointLight{{2, 4, 1}, {3, 3, 3}, true}, list);
     },
     true},
    {"spot",
     [](Scene& s, std::uint32_t list) {
       add_light(s, SpotLight{{1, 4, 1}, {-0.2, -1, -0.2}}, list);
     },
     true},
    {"sun",
     [](Scene& s, std::uint32_t list) {
       add_light(s, DirectionalLight{{-1, -2, 0}, {1, 1, 1}, 10}, list);
     },
     true},
    {"environment",
     [](Scene& s, std::uint32_t list) {
       add_light(s, even_environment({1, 1, 1}), list);
     },
     false},
    {"environments",
     [](Scene& s, std::uint32_t list) {
       add_light(s, even_environment({0.5f, 1, 1}), list);
       add_light(s, DirectionalLight{{-1, -2, 0}, {1, 1, 1}, 10}, list);
     },
     false},
    {"ball",
     [](Scene& s, std::uint32_t list) {
       add_lamp(s, SphereShape{{2, 2, 1}, 0.4}, list);
     },
     true},
    {"rectangle",
     [](Scene& s, std::uint32_t list) {
       add_lamp(s, PolygonShape{{{-1, 2.5, -1}, {1, 2.5, -1}, {1, 2.5, 1}, {-1, 2.5, 1}}}, list);
     },
     true},
    // Not sampled, so only bounces find it.
    {"box",
     [](Scene& s, std::uint32_t list) {
       add_lamp(s, BoxShape{{1, 1, 0}, {2, 2, 1}}, list);
     },
     false},
};

enum class For { all, ball_only, all_but_ball };

Picture lit(const Lamp& lamp, Scene scene, For whom) {
  scene.objects[1].listed = whom == For::all ? 0 : 1;
  if (whom != For::all) scene.light_lists.push_back({whom == For::all_but_ball});
  lamp.add(scene, whom == For::all ? kNoId : 0u);
  return run(scene).picture;
}

TEST(LightLists, PartsAddUpToTheWhole) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path})
    for (const std::uint32_t depth : {0u, 3u})
      for (const Lamp& lamp : kLamps) {
        if (kind == IntegratorKind::whitted && !lamp.whitted) continue;
        Scene scene = things(kind, depth);
        scene.integrator.light_samples = kind == IntegratorKind::whitted ? 4 : 0;
        const Picture whole = lit(lamp, scene, For::all), ball = lit(lamp, scene, For::ball_only),
                      others = lit(lamp, scene, For::all_but_ball);
        const Picture things_alone = run(scene).picture;
        const bool environment = std::string(lamp.name).starts_with("environment") ||
                                 (kind == IntegratorKind::path && std::string(lamp.name) == "sun");
        double of_ball = 0, of_others = 0;
        for (std::uint32_t y = 0; y < whole.height; ++y)
          for (std::uint32_t x = 0; x < whole.width; ++x) {
            // Rays of the camera see the environment in both.
            if (environment && value(things_alone, "A", x, y) < 1) continue;
            const Color a = color(ball, x, y), b = color(others, x, y), c = color(whole, x, y);
            for (int k = 0; k < 3; ++k)
              EXPECT_NEAR(a[k] + b[k], c[k], 1e-5f + 1e-4f * c[k])
                  << lamp.name << depth << ' ' << x << ' ' << y;
            of_ball += static_cast<double>(a.x), of_others += static_cast<double>(b.x);
          }
        EXPECT_GT(of_ball, 0.2) << lamp.name;
        EXPECT_GT(of_others, 0.5) << lamp.name;
      }
}

TEST(LightLists, DirectLightIsExactlyOnWhatIsListed) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path})
    for (const Lamp& lamp : kLamps) {
      if (kind == IntegratorKind::whitted && !lamp.whitted) continue;
      Scene scene = things(kind, 0);
      scene.integrator.samples = 1;
      scene.integrator.light_samples = kind == IntegratorKind::whitted ? 4 : 0;
      const Picture whole = lit(lamp, scene, For::all), ball = lit(lamp, scene, For::ball_only);
      for (std::uint32_t y = 0; y < whole.height; ++y)
        for (std::uint32_t x = 0; x < whole.width; ++x) {
          if (id(whole, "geomID.I", x, y) == kNoId) continue;
          const bool on_ball = id(whole, "geomID.I", x, y) == 1;
          EXPECT_EQ(color(ball, x, y), on_ball ? color(whole, x, y) : (Color{0, 0, 0})) << lamp.name;
        }
    }
}

TEST(LightLists, TwoLightsForDifferentObjectsAddUp) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path}) {
    Scene scene = things(kind, 0);
    scene.integrator.samples = 256, scene.film.width = scene.film.height = 6;
    scene.objects[0].listed = 1, scene.objects[1].listed = 2;
    scene.light_lists.resize(2);
    const auto with = [&](bool first, bool second) {
      Scene some = scene;
      if (first) add_light(some, PointLight{{2, 4, 1}, {3, 0, 0}, true}, 0);
      if (second) add_light(some, PointLight{{-2, 4, 1}, {0, 3, 0}, true}, 1);
      return run(some).picture;
    };
    const Picture both = with(true, true), one = with(true, false), other = with(false, true);
    for (std::uint32_t y = 0; y < 6; ++y)
      for (std::uint32_t x = 0; x < 6; ++x) {
        const Color sum = color(one, x, y) + color(other, x, y);
        for (int k = 0; k < 3; ++k)
          EXPECT_NEAR(value(both, k == 0 ? "R" : k == 1 ? "G" : "B", x, y), sum[k], 0.02f + 0.1f * sum[k]);
      }
  }
}

TEST(LightLists, MirrorsShowOnlyTheLightsThatAreForThem) {
  Scene scene = things(IntegratorKind::path, 2);
  scene.materials[1] = mirror();
  scene.objects[1].listed = 1;
  scene.light_lists.resize(1);
  Scene dark = scene;
  dark.light_lists[0].lights_others = true;
  const auto light = [](Scene& s) {
    s.objects.erase(s.objects.begin());  // the floor
    add_light(s, even_environment({1, 1, 1}), 0);
  };
  light(scene), light(dark);
  const Picture seen = run(scene).picture, unseen = run(dark).picture;
  std::size_t on_ball = 0;
  for (std::uint32_t y = 0; y < 12; ++y)
    for (std::uint32_t x = 0; x < 12; ++x) {
      const float cover = value(seen, "Albedo.R", x, y);
      on_ball += cover == 1 ? 1 : 0;
      EXPECT_NEAR(value(seen, "R", x, y), 1, 1e-4);
      EXPECT_NEAR(value(unseen, "R", x, y), 1 - cover, 1e-4);
    }
  EXPECT_GT(on_ball, 3u);
}

TEST(LightLists, InstancesAndCombinationsAreLitWithWhatTheyShow) {
  for (const bool combination : {false, true})
    for (const bool own_material : {false, true}) {
      Scene scene = things(IntegratorKind::path, 0);
      const Object ball = scene.objects[1];
      Object around;
      if (combination) {
        around.shape = CsgShape{CsgOp::unite, std::make_shared<const std::vector<Object>>(std::vector{ball})};
      } else {
        scene.prototypes.push_back({"ball", {ball}});
        around.shape = InstanceShape{0};
        if (own_material) around.material = ball.material;
      }
      scene.objects[1] = around;
      add_light(scene, PointLight{{2, 4, 1}, {3, 3, 3}, true}, 0);
      scene.light_lists.resize(1);
      const auto light = [&](std::uint16_t outer, std::uint16_t inner) {
        Scene s = scene;
        s.objects[1].listed = outer;
        if (!combination) s.prototypes[0].objects[0].listed = inner;
        const Picture p = run(s).picture;
        double sum = 0;
        for (std::uint32_t y = 0; y < 12; ++y)
          for (std::uint32_t x = 0; x < 12; ++x) sum += static_cast<double>(value(p, "R", x, y));
        return sum;
      };
      EXPECT_EQ(light(0, 0), 0);
      EXPECT_GT(light(1, 0), 0.5);
      if (!combination) {
        EXPECT_EQ(light(0, 1), light(1, 0));
      }
    }
}

TEST(LightLists, CausticsAndLayersOfEnvironmentsAreRefused) {
  const auto error_of = [](const Scene& scene) -> std::string {
    try {
      run(scene);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  Scene scene = things(IntegratorKind::path, 1);
  scene.light_lists.push_back({false, Location{"a.yaml", 2, 3}});
  add_light(scene, even_environment({1, 1, 1}), 0);
  add_light(scene, even_environment({1, 0, 1}), kNoId);
  EXPECT_EQ(error_of(scene), "no error");
  Scene layers = scene;
  layers.light_traits[0].group = "key";
  EXPECT_EQ(error_of(layers).substr(0, 27), "a.yaml:2:3: light groups ca");
  scene.integrator.caustics.photons = 100;
  EXPECT_EQ(error_of(scene), "a.yaml:2:3: photons of 'caustics' light all objects");
}

}  // namespace
}  // namespace oktett::light_lists_test
