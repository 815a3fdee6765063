/// \file Which rays meet an object: what hides is compared with the same scene without what is hidden.

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "render/geometry.h"
#include "tests/render/test_scenes.h"

namespace oktett::visibility_test {
namespace {

using namespace test;

constexpr std::uint8_t without(RayKind kind) { return static_cast<std::uint8_t>(kAllRays & ~bit_of(kind)); }
constexpr std::uint8_t without(RayKind a, RayKind b) { return without(a) & without(b); }

/// A grey floor, seen from above.
Scene floor_scene(IntegratorKind kind, std::uint32_t samples = 4, std::uint32_t size = 12) {
  Scene scene = bare_scene(size);
  scene.integrator.kind = kind, scene.integrator.samples = samples, scene.integrator.depth = 0;
  scene.camera.from = {0, 3, 4}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 40;
  add_object(scene, PolygonShape{{{-4, 0, -4}, {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}}},
             add_material(scene, diffuse({0.5f, 0.6f, 0.7f})));
  return scene;
}

void add_rectangle_light(Scene& scene, const Vec3d& corner, const Vec3d& u, const Vec3d& v,
                         const Color& radiance) {
  Material m = glowing(radiance);
  m.emits_behind = false;
  add_object(scene, PolygonShape{{corner, corner + u, corner + u + v, corner + v}}, add_material(scene, m));
}

EnvironmentLight even_environment(const Color& radiance) {
  auto picture = std::make_shared<EnvironmentPicture>();
  picture->width = picture->height = 1, picture->pixels = {radiance};
  return EnvironmentLight{picture};
}

/// The greatest difference of the colours of two pictures.
double difference(const Picture& a, const Picture& b) {
  double most = 0;
  for (std::uint32_t y = 0; y < a.height; ++y)
    for (std::uint32_t x = 0; x < a.width; ++x)
      most = std::max(most, static_cast<double>(max_component(abs(color(a, x, y) - color(b, x, y)))));
  return most;
}

double mean(const Picture& p) {
  double sum = 0;
  for (std::uint32_t y = 0; y < p.height; ++y)
    for (std::uint32_t x = 0; x < p.width; ++x) sum += static_cast<double>(value(p, "R", x, y));
  return sum / (p.width * p.height);
}

/// A ball that would shade the middle of the floor.
void add_blocker(Scene& scene, std::uint8_t visible_to) {
  add_object(scene, SphereShape{{0, 1, 0}, 0.5}, add_material(scene, diffuse({0, 0, 0})));
  scene.objects.back().visible_to = visible_to;
}

TEST(Visibility, ShadowRaysPassWhatIsNotForThem) {
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path}) {
    Scene scene = floor_scene(kind);
    scene.lights = {PointLight{{0, 3, 0}, {2, 2, 2}, true}};
    const Picture open = run(scene).picture;
    add_blocker(scene, without(RayKind::camera, RayKind::shadow));
    EXPECT_TRUE(same_bytes(run(scene).picture, open));
    scene.objects.back().visible_to = without(RayKind::camera);
    EXPECT_GT(difference(run(scene).picture, open), 0.01);
  }
}

TEST(Visibility, CameraRaysPassWhatIsNotForThemAndItsShadowStays) {
  Scene scene = floor_scene(IntegratorKind::whitted);
  scene.lights = {PointLight{{0, 3, 0}, {2, 2, 2}, true}};
  add_blocker(scene, kAllRays);
  const Picture all = run(scene).picture;
  scene.objects.back().visible_to = without(RayKind::camera);
  const Picture hidden = run(scene).picture;
  std::size_t floor = 0;
  for (std::uint32_t y = 0; y < all.height; ++y)
    for (std::uint32_t x = 0; x < all.width; ++x) {
      EXPECT_NE(id(hidden, "geomID.I", x, y), 1u);
      if (value(all, "P.Y", x, y) > 1e-3f) continue;
      EXPECT_EQ(color(hidden, x, y), color(all, x, y));
      ++floor;
    }
  EXPECT_GT(floor, 50u);
  scene.integrator.kind = IntegratorKind::normal;
  const Picture normals = run(scene).picture;
  scene.objects.pop_back();
  EXPECT_TRUE(same_bytes(normals, run(scene).picture));
}

TEST(Visibility, NeitherEmittersNorTheEnvironmentGainOrLoseLightBehindAShadowlessObject) {
  // Light samples and bounces find the same light, and only the former's rays pass the ball.
  for (const bool environment : {false, true})
    for (const bool glossy : {false, true}) {
      Scene scene = floor_scene(IntegratorKind::path, 64, 8);
      if (glossy) {
        Material m = diffuse({0.8f, 0.8f, 0.8f});
        m.principled = principled_like(m);
        m.principled->parameters.metallic = 1, m.principled->parameters.roughness = 0.3f;
        scene.materials[0] = m;
      }
      if (environment)
        scene.lights = {even_environment({1, 1, 1})};
      else
        add_rectangle_light(scene, {-2, 2.5, -2}, {4, 0, 0}, {0, 0, 4}, {1, 1, 1});
      scene.objects[0].visible_to = kAllRays;
      const Picture open = run(scene).picture;
      EXPECT_GT(mean(open), 0.1);
      add_blocker(scene, without(RayKind::camera, RayKind::shadow));
      EXPECT_LT(difference(run(scene).picture, open), 1e-4) << environment << glossy;
      scene.objects.back().visible_to = without(RayKind::camera);
      EXPECT_GT(difference(run(scene).picture, open), 0.01);
      // The other way round the light is blocked for both.
      const Picture blocked = run(scene).picture;
      scene.objects.back().visible_to = bit_of(RayKind::shadow);
      EXPECT_NEAR(mean(run(scene).picture), mean(blocked), 0.01 * mean(blocked));
    }
}

TEST(Visibility, LightBehindHolesCountsOnce) {
  Scene scene = floor_scene(IntegratorKind::path, 1024, 4);
  add_rectangle_light(scene, {-2, 2.5, -2}, {4, 0, 0}, {0, 0, 4}, {1, 1, 1});
  Material half = diffuse({0, 0, 0});
  half.opacity = 0.5f;
  add_object(scene, PolygonShape{{{-4, 1, -4}, {-4, 1, 4}, {4, 1, 4}, {4, 1, -4}}},
             add_material(scene, half));
  scene.objects.back().visible_to = without(RayKind::camera);
  const double expected = mean(run(scene).picture);
  add_blocker(scene, without(RayKind::camera, RayKind::shadow));
  EXPECT_NEAR(mean(run(scene).picture), expected, 0.02 * expected);
}

TEST(Visibility, BouncesMeetWhatIsForTheKindOfTheirLobe) {
  // A glowing ball before the camera's back, in a mirror, through glass, or lighting a matt or a rough wall.
  const auto shown = [](const Material& wall, std::uint8_t visible_to, IntegratorKind kind) {
    Scene scene = bare_scene(6);
    scene.integrator.kind = kind, scene.integrator.samples = 16, scene.integrator.depth = 2;
    scene.camera.from = {0, 0, 3}, scene.camera.at = {0, 0, 0};
    add_object(scene, PolygonShape{{{-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0}}},
               add_material(scene, wall));
    // Around everything, so that each direction meets it.
    add_object(scene, SphereShape{{0, 0, 0}, 10}, add_material(scene, glowing({1, 1, 1})));
    scene.objects.back().visible_to = visible_to;
    return mean(run(scene).picture);
  };
  Material clear = glass(1.0f);
  Material rough = diffuse({1, 1, 1});
  rough.principled = principled_like(rough);
  rough.principled->parameters.metallic = 1, rough.principled->parameters.roughness = 0.5f;
  for (const IntegratorKind kind : {IntegratorKind::whitted, IntegratorKind::path}) {
    EXPECT_NEAR(shown(mirror(), without(RayKind::diffuse, RayKind::transmission), kind), 1, 1e-3);
    EXPECT_EQ(shown(mirror(), without(RayKind::glossy), kind), 0);
    EXPECT_NEAR(shown(clear, without(RayKind::diffuse, RayKind::glossy), kind), 1, 1e-3);
    EXPECT_EQ(shown(clear, without(RayKind::transmission), kind), 0);
  }
  EXPECT_EQ(shown(diffuse({1, 1, 1}), without(RayKind::diffuse), IntegratorKind::path), 0);
  // Without light samples, which could not tell the lobes apart; a white wall shows all of it.
  EXPECT_NEAR(shown(diffuse({1, 1, 1}), without(RayKind::glossy), IntegratorKind::path), 1, 1e-3);
  EXPECT_EQ(shown(rough, without(RayKind::glossy), IntegratorKind::path), 0);
  EXPECT_NEAR(shown(rough, without(RayKind::diffuse), IntegratorKind::path),
              shown(rough, kAllRays, IntegratorKind::path), 0.02);
}

TEST(Visibility, AmbientOcclusionAsksShadowRays) {
  Scene scene = floor_scene(IntegratorKind::ao, 16);
  scene.integrator.ao_radius = 2;
  const Picture open = run(scene).picture;
  add_blocker(scene, without(RayKind::camera, RayKind::shadow));
  EXPECT_TRUE(same_bytes(run(scene).picture, open));
}

/// Pictures of normals and of albedo without the numbers of objects.
bool looks_the_same(const Picture& a, const Picture& b) {
  for (const char* plane : {"R", "G", "B", "A", "N.X", "N.Y", "N.Z", "Z", "P.X", "P.Y", "P.Z"})
    for (std::uint32_t y = 0; y < a.height; ++y)
      for (std::uint32_t x = 0; x < a.width; ++x)
        if (value(a, plane, x, y) != value(b, plane, x, y)) return false;
  return true;
}

/// Balls beside each other, of which every third is hidden or missing.
std::vector<Object> row_of_balls(bool hidden, std::uint32_t material) {
  std::vector<Object> objects;
  for (int i = 0; i < 9; ++i) {
    Object ball;
    ball.shape = SphereShape{{i * 0.5 - 2, 0.3, 0}, 0.3};
    ball.material = material;
    if (i % 3 == 1) {
      if (!hidden) continue;
      ball.visible_to = without(RayKind::camera);
    }
    objects.push_back(ball);
  }
  return objects;
}

TEST(Visibility, HoldsInPrototypesAndListsOfInstances) {
  const auto picture = [](bool hidden, bool in_instances) {
    Scene scene = floor_scene(IntegratorKind::whitted, 4, 24);
    scene.lights = {PointLight{{0, 5, 5}, {1, 1, 1}}};
    const std::uint32_t red = add_material(scene, diffuse({1, 0, 0}));
    scene.prototypes.push_back({"row", row_of_balls(hidden, red)});
    scene.prototypes.push_back({"ball", {}});
    Object ball;
    ball.shape = BoxShape{{-0.1, 0, -0.1}, {0.1, 0.2, 0.1}}, ball.material = red;
    scene.prototypes.back().objects.push_back(ball);
    // Enough instances in a row for a list; some hide themselves, some hold what hides.
    for (int i = 0; i < 200; ++i) {
      Object instance;
      instance.shape = InstanceShape{i % 5 == 0 ? 0u : 1u};
      instance.transform = Affine::translation({0.25 * (i % 14) - 2, 0, 0.5 * (i / 14) - 3});
      if (i % 7 == 3 && in_instances) {
        if (!hidden) continue;
        instance.visible_to = without(RayKind::camera);
      }
      scene.objects.push_back(instance);
    }
    // Shadow rays meet all, so they are asked of a light that no object hides.
    scene.integrator.kind = IntegratorKind::albedo;
    return run(scene).picture;
  };
  EXPECT_TRUE(looks_the_same(picture(true, false), picture(false, false)));
  EXPECT_TRUE(looks_the_same(picture(true, true), picture(false, true)));
}

TEST(Visibility, HoldsForCombinationsAndWhatMoves) {
  const auto picture = [](bool hidden) {
    Scene scene = floor_scene(IntegratorKind::albedo, 4, 24);
    scene.camera.shutter[0] = 0, scene.camera.shutter[1] = 1;
    const std::uint32_t red = add_material(scene, diffuse({1, 0, 0}));
    for (int i = 0; i < 8; ++i) {
      Object object;
      object.material = red;
      if (i % 4 < 2) {
        std::vector<Object> operands(2);
        operands[0].shape = BoxShape{{-0.4, 0, -0.4}, {0.4, 0.8, 0.4}}, operands[0].material = red;
        operands[1].shape = SphereShape{{0, 0.8, 0}, 0.4}, operands[1].material = red;
        object.shape = CsgShape{CsgOp::subtract, std::make_shared<const std::vector<Object>>(operands)};
      } else {
        object.shape = SphereShape{{0, 0.4, 0}, 0.4};
      }
      const Affine place = Affine::translation({0.8 * (i % 4) - 1.2, 0, i / 4 - 0.5});
      object.transform = place;
      if (i >= 4) {
        Motion motion;
        motion.factors.push_back({{0, place}, {1, Affine::translation({0, 0.5, 0}) * place}});
        object.motion = std::make_shared<const Motion>(motion);
      }
      if (i % 2 == 1) {
        if (!hidden) continue;
        object.visible_to = without(RayKind::camera);
      }
      scene.objects.push_back(object);
    }
    return run(scene).picture;
  };
  EXPECT_TRUE(looks_the_same(picture(true), picture(false)));
}

TEST(Visibility, VolumesMeanNothingWithoutMedia) {
  Scene scene = floor_scene(IntegratorKind::path);
  add_rectangle_light(scene, {-2, 2.5, -2}, {4, 0, 0}, {0, 0, 4}, {1, 1, 1});
  const Picture all = run(scene).picture;
  scene.objects.back().visible_to = without(RayKind::volume);
  EXPECT_FALSE(hides_objects(build_world(scene)));
  EXPECT_TRUE(same_bytes(run(scene).picture, all));
}

TEST(Visibility, HitsAreNumberedAsThoseOfAllObjects) {
  Scene scene = floor_scene(IntegratorKind::albedo);
  add_blocker(scene, without(RayKind::camera));
  add_object(scene, SphereShape{{1, 1, 0}, 0.5}, 0);
  const World world = build_world(scene);
  EXPECT_TRUE(hides_objects(world));
  EXPECT_FALSE(bounces_differ(world));
  EXPECT_EQ(&seen_by(world, RayKind::shadow), world.accel.get());
  const Ray down{{1, 5, 0}, 0, {0, -1, 0}};
  const Hit all = closest_hit(*world.accel, down), seen = closest_hit(seen_by(world, RayKind::camera), down);
  EXPECT_EQ(all.item, seen.item);
  EXPECT_EQ(all.t, seen.t);
  scene.objects[1].visible_to = kAllRays;
  const World plain = build_world(scene);
  EXPECT_FALSE(hides_objects(plain));
  EXPECT_EQ(plain.bvh_bytes, build_world(scene).bvh_bytes);
}

/// What run() says is wrong.
std::string error_of(const Scene& scene) {
  try {
    run(scene);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Visibility, RefusesWhatItCannotHonour) {
  Scene scene = floor_scene(IntegratorKind::path);
  add_blocker(scene, without(RayKind::shadow));
  scene.objects.back().where = Location{"a.yaml", 3, 5};
  scene.integrator.caustics.photons = 100;
  EXPECT_EQ(error_of(scene),
            "a.yaml:3:5: photons of 'caustics' do not know which rays an object is visible to");
  scene.integrator.caustics.photons = 0;
  EXPECT_EQ(error_of(scene), "no error");
  scene.media.emplace_back();
  scene.medium = 0;
  EXPECT_EQ(error_of(scene), "no error");
  scene.materials[scene.objects.back().material] = glass(1.5f);
  EXPECT_EQ(error_of(scene),
            "a.yaml:3:5: with media or priorities, what light enters must be visible to all rays");
}

TEST(Visibility, MediaScatterToWhatIsForVolumes) {
  // Fog before a glowing wall that the camera does not see.
  const auto fog = [](std::uint8_t visible_to) {
    Scene scene = bare_scene(6);
    scene.integrator.kind = IntegratorKind::path, scene.integrator.samples = 2048, scene.integrator.depth = 1;
    Medium medium;
    medium.scattering = {0.2f, 0.2f, 0.2f};
    scene.media.push_back(medium);
    scene.medium = 0;
    scene.camera.from = {0, 0, 3}, scene.camera.at = {0, 0, 0};
    add_object(scene, PolygonShape{{{-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0}}},
               add_material(scene, diffuse({0, 0, 0})));
    add_object(scene, SphereShape{{3, 0, 2}, 1.8}, add_material(scene, glowing({5, 5, 5})));
    scene.objects.back().visible_to = visible_to;
    return mean(run(scene).picture);
  };
  const double all = fog(without(RayKind::camera));
  EXPECT_GT(all, 0.01);
  EXPECT_EQ(fog(without(RayKind::camera, RayKind::volume)), 0);
  // Found by bounces alone, the light is the same.
  EXPECT_NEAR(fog(without(RayKind::camera, RayKind::diffuse)), all, 0.03 * all);
}

}  // namespace
}  // namespace oktett::visibility_test
