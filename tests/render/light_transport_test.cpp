/// \file Path tracing against closed forms and quadrature: one point of a white floor under lamps of all
/// kinds.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "render/scene_lights.h"
#include "tests/render/test_scenes.h"

namespace oktett::light_transport_test {
namespace {

using namespace test;

/// A camera of one pixel that sees the origin, a point of a white diffuse floor at y = 0. It stands beside
/// the floor's normal, so that lamps above are not in its way.
Scene floor_scene(std::uint32_t samples, std::uint32_t depth = 0) {
  Scene scene = bare_scene(1);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = samples, scene.integrator.depth = depth;
  scene.camera.from = {0, 0.4, 5}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 0.001;
  add_object(scene, DiskShape{{0, 0, 0}, {0, 1, 0}, 0.05}, add_material(scene, diffuse({1, 1, 1})));
  return scene;
}

/// What the camera sees. A white diffuse surface shows its irradiance divided by pi.
double seen(const Scene& scene, const std::function<void(RenderOptions&)>& change = {}) {
  return static_cast<double>(value(run(scene, change).picture, "G", 0, 0));
}

/// The standard deviation of what the camera sees, by the picture's own estimate.
double deviation(const Scene& scene) {
  return std::sqrt(static_cast<double>(value(run(scene).picture, "Variance.G", 0, 0)));
}

/// Irradiance / pi at the origin of the plane y = 0 by a parallelogram of radiance 1 that emits on both
/// sides: the midpoint rule over its area.
double quadrature(const Vec3d& corner, const Vec3d& u, const Vec3d& v) {
  constexpr int kSteps = 400;
  const Vec3d n = cross(u, v);
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int k = 0; k < kSteps; ++k) {
      const Vec3d p = corner + u * ((i + 0.5) / kSteps) + v * ((k + 0.5) / kSteps);
      const double square = dot(p, p);
      sum += std::max(0.0, p.y) * std::abs(dot(n, p)) / (square * square) / (kSteps * kSteps);
    }
  return sum / std::numbers::pi;
}

// Light of less than 1/4096 is not lost: there is no cut.
TEST(LightTransport, NothingIsTooDarkToCount) {
  Scene scene = bare_scene(4);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = 64, scene.integrator.depth = 4;
  scene.background = {1e6f, 1e6f, 1e6f};
  add_object(scene, SphereShape{{0, 0, 0}, 4}, add_material(scene, diffuse({1e-6f, 1e-6f, 1e-6f})));
  EXPECT_NEAR(value(run(scene).picture, "R", 2, 2), 1, 1e-4f);
}

TEST(LightTransport, SphereLampsGiveTheLightOfTheirCap) {
  for (const auto& [center, radius] :
       {std::pair{Vec3d{0, 3, 0}, 0.5}, std::pair{Vec3d{1, 2, 0.5}, 0.05}, std::pair{Vec3d{-2, 3, 1}, 2.0},
        std::pair{Vec3d{300, 400, 0}, 20.0}}) {
    Scene scene = floor_scene(4096);
    add_object(scene, SphereShape{center, radius}, add_material(scene, glowing({2, 3, 4})));
    // A ball that is wholly above the horizon: L (r / d)^2 cos.
    const double square = dot(center, center), cosine = center.y / std::sqrt(square);
    const double want = 3 * radius * radius / square * cosine;
    EXPECT_NEAR(seen(scene), want, 0.003 * want) << center.x;
  }
}

TEST(LightTransport, DiskLampAboveThePoint) {
  Scene scene = floor_scene(4096);
  Material lamp = glowing({1, 1, 1});
  lamp.emits_behind = false;
  add_object(scene, DiskShape{{0, 2, 0}, {0, -1, 0}, 1.5}, add_material(scene, lamp));
  const double want = 1.5 * 1.5 / (1.5 * 1.5 + 4);
  EXPECT_NEAR(seen(scene), want, 0.005 * want);
  // Turned round, its dark side lights nothing.
  scene.objects.back().shape = DiskShape{{0, 2, 0}, {0, 1, 0}, 1.5};
  EXPECT_EQ(seen(scene), 0);
}

// The same lamp as a polygon, as a mesh, in nested instances that turn and mirror it, and with a texture.
TEST(LightTransport, RectanglesMeshesAndInstancesMatchQuadrature) {
  const Vec3d corner{-0.5, 1.5, -2}, u{2, 0.5, 0}, v{-0.25, 1, 1.5};
  ASSERT_EQ(dot(u, v), 0);
  const double want = quadrature(corner, u, v);
  const auto expect_light = [&](const Scene& scene) {
    EXPECT_NEAR(seen(scene), want, 0.01 * want);
    EXPECT_LT(deviation(scene), 0.01 * want);
  };
  Scene scene = floor_scene(4096);
  const std::uint32_t lamp = add_material(scene, glowing({1, 1, 1}));
  add_object(scene, PolygonShape{{corner, corner + u, corner + u + v, corner + v}}, lamp);
  expect_light(scene);

  scene.objects.back().shape = MeshShape{parallelogram(Vec3f(corner), Vec3f(u), Vec3f(v)), {lamp}, false};
  scene.objects.back().material = kNoId;
  expect_light(scene);

  // The mesh as a unit square in a prototype in a prototype.
  Object square, inner;
  square.shape = MeshShape{parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), {}, false};
  square.material = lamp;
  inner.shape = InstanceShape{0};
  inner.transform = Affine::scaling({-1, 1, 1});
  scene.prototypes = {{"square", {square}}, {"mirrored", {inner}}};
  Affine place;
  const Vec3d n = cross(u, v);
  for (std::size_t k = 0; k < 3; ++k) {
    place.m[k][0] = -u[static_cast<int>(k)], place.m[k][1] = v[static_cast<int>(k)];
    place.m[k][2] = n[static_cast<int>(k)], place.m[k][3] = corner[static_cast<int>(k)];
  }
  scene.objects.back() = Object{};
  scene.objects.back().shape = InstanceShape{1}, scene.objects.back().transform = place;
  expect_light(scene);
}

/// Half as bright on one half of the square, one and a half times as bright on the other.
class HalvedTexture : public TextureSampler {
 public:
  Color color(std::uint32_t, Vec2f uv, Vec2f, Vec2f) const override {
    return uv.x < 0.5f ? Color{0.5f, 0.5f, 0.5f} : Color{1.5f, 1.5f, 1.5f};
  }
  float value(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return 1; }
};

TEST(LightTransport, TexturesOfEmissionLightTheScene) {
  Scene scene = floor_scene(4096);
  Material lamp = glowing({2, 2, 2});
  lamp.emission_texture = 0;
  const std::uint32_t material = add_material(scene, lamp);
  add_object(scene, MeshShape{parallelogram({0, 1, 0}, {2, 0, 0}, {0, 0, 1}), {}, false}, material);
  const HalvedTexture textures;
  const double want = 2 * (0.5 * quadrature({0, 1, 0}, {1, 0, 0}, {0, 0, 1}) +
                           1.5 * quadrature({1, 1, 0}, {1, 0, 0}, {0, 0, 1}));
  EXPECT_NEAR(seen(scene, [&](RenderOptions& o) { o.textures = &textures; }), want, 0.01 * want);
}

// A box as a mesh is sampled, as an exact box it is not: multiple importance sampling and brute force see the
// same light, also by way of a second surface.
TEST(LightTransport, SampledAndUnsampledLampsAgree) {
  const auto scene_with = [](bool sampled) {
    Scene scene = floor_scene(16384, 2);
    add_object(scene, PlaneShape{{0, 0, 1}, -2}, 0);
    const std::uint32_t lamp = add_material(scene, glowing({3, 2, 1}));
    if (!sampled) {
      add_object(scene, BoxShape{{-0.5, 2, -0.5}, {-0.25, 2.25, 0}}, lamp);
      return scene;
    }
    const Vec3f lo{-0.5f, 2, -0.5f}, hi{-0.25f, 2.25f, 0};
    const Vec3f x{0.25f, 0, 0}, y{0, 0.25f, 0}, z{0, 0, 0.5f};
    for (const auto& [corner, u, v] :
         {std::tuple{lo, x, y}, {lo, x, z}, {lo, y, z}, {hi, -x, -y}, {hi, -x, -z}, {hi, -y, -z}})
      add_object(scene, MeshShape{parallelogram(corner, u, v), {}, false}, lamp);
    return scene;
  };
  const Scene with = scene_with(true), without = scene_with(false);
  const double sigma = std::hypot(deviation(with), deviation(without));
  EXPECT_NEAR(seen(with), seen(without), 3 * sigma);
  EXPECT_LT(deviation(with), 0.5 * deviation(without));
}

// In a closed room of glowing triangles light is emission / (1 - albedo) everywhere.
TEST(LightTransport, AFurnaceOfSampledLightKeepsItsEnergy) {
  // Turned, so that the places on its walls are rounded.
  const Affine turned = Affine::rotation({20, 35, 10});
  for (const bool principled : {false, true}) {
    Scene scene = bare_scene(8);
    scene.integrator.kind = IntegratorKind::path;
    scene.integrator.samples = 64, scene.integrator.depth = 64;
    scene.camera.from = {0.3, 0.2, 0.5};
    Material wall = diffuse({0.5f, 0.5f, 0.5f});
    wall.emission = {0.5f, 0.5f, 0.5f};
    const std::uint32_t room = add_material(scene, wall);
    for (const double side : {-1.0, 1.0})
      for (int axis = 0; axis < 3; ++axis) {
        Vec3f corner, u, v;
        corner[axis] = static_cast<float>(side), u[(axis + 1) % 3] = 2, v[(axis + 2) % 3] = 2;
        corner[(axis + 1) % 3] = corner[(axis + 2) % 3] = -1;
        add_object(scene, MeshShape{parallelogram(corner, u, v), {}, false}, room, turned);
      }
    Material ball = glass(1.5f);
    if (principled) {
      ball.principled.emplace();
      ball.principled->parameters.base_color = {1, 1, 1};
      ball.principled->parameters.metallic = 0.5f, ball.principled->parameters.transmission = 0.5f;
      ball.principled->parameters.roughness = 0.4f;
      ball.color = {1, 1, 1};
    }
    add_object(scene, SphereShape{{-0.4, -0.4, -0.4}, 0.4}, add_material(scene, ball));
    double mean = 0;
    const Picture picture = run(scene).picture;
    for (const float x : picture.find("R")->values) mean += static_cast<double>(x) / 64;
    EXPECT_NEAR(mean, 1, 0.008) << principled;
  }
}

// Mirrors show a lamp as it is; light that they pass on is not counted twice.
TEST(LightTransport, MirrorsShowLampsOnce) {
  Scene scene = floor_scene(16);
  scene.materials[0] = mirror();
  scene.camera.from = {0, 3, 4};
  add_object(scene, SphereShape{{0, 3, -4}, 1}, add_material(scene, glowing({5, 5, 5})));
  EXPECT_EQ(seen(scene), 5);
}

// Clear things between lamp and floor change nothing: a sheet of holes, which lets sampled light pass, and
// glass of index 1, behind which light is found by the floor's own rays.
TEST(LightTransport, ClearThingsInBetweenChangeNothing) {
  class Holes : public HalvedTexture {
   public:
    float value(std::uint32_t, Vec2f, Vec2f, Vec2f) const override { return 0; }
  };
  const Holes textures;
  const auto with_textures = [&](RenderOptions& o) { o.textures = &textures; };
  const double want = 2.0 * 0.5 * 0.5 / 9;
  Scene scene = floor_scene(16384, 4);
  add_object(scene, SphereShape{{0, 3, 0}, 0.5}, add_material(scene, glowing({2, 2, 2})));
  Material hole = diffuse({0, 0, 0});
  hole.opacity_texture = 0;
  add_object(scene, DiskShape{{0, 1, 0}, {0, 1, 0}, 0.3}, add_material(scene, hole));
  EXPECT_NEAR(seen(scene, with_textures), want, 0.003 * want);
  scene.materials.back() = glass(1);
  EXPECT_NEAR(seen(scene), want, 0.1 * want);
}

TEST(LightTransport, EnvironmentsLightLikeTheirPixels) {
  // One bright pixel of 64 x 32: its irradiance is radiance times the integral of the cosine over it.
  EnvironmentPicture picture;
  picture.width = 64, picture.height = 32;
  picture.pixels.assign(64 * 32, Color{0, 0, 0});
  constexpr int kRow = 9;
  picture.pixels[kRow * 64 + 20] = {100, 100, 100};
  EnvironmentLight light;
  light.picture = std::make_shared<const EnvironmentPicture>(picture);
  light.rotation = 77, light.color = {1, 0.5f, 1};
  Scene scene = floor_scene(4096);
  scene.lights = {light};
  // Bilinear interpolation spreads the pixel, but its rows count almost as if they were constant: quadrature
  // of the tent over the polar angle.
  double tent = 0;
  constexpr int kSteps = 10000;
  for (int i = 0; i < kSteps; ++i) {
    const double row = kRow + 0.5 + 2 * ((i + 0.5) / kSteps - 0.5), polar = std::numbers::pi * row / 32;
    tent += (1 - std::abs(row - kRow - 0.5)) * std::cos(polar) * std::sin(polar) *
            (2 * std::numbers::pi / 32 / kSteps);
  }
  const double want = 50 * tent * (2 * std::numbers::pi / 64) / std::numbers::pi;
  EXPECT_NEAR(seen(scene), want, 0.01 * want);

  // A constant one shows its colour times the albedo, by any weights.
  picture.pixels.assign(64 * 32, Color{2, 2, 2});
  light.picture = std::make_shared<const EnvironmentPicture>(picture);
  light.color = {1, 1, 1};
  scene.lights = {light};
  EXPECT_NEAR(seen(scene), 2, 0.01);
}

// A sun of half a degree gives the irradiance of parallel light; it is seen by mirrors.
TEST(LightTransport, SunsAreParallelLightWithAnArea) {
  Scene scene = floor_scene(1024);
  scene.lights = {DirectionalLight{{-1, -2, 0}, {1, 3, 1}, 0.53}};
  EXPECT_NEAR(seen(scene), 3 * 2 / std::sqrt(5.0), 0.01);
  scene.materials[0] = mirror();
  scene.camera.from = {-1, 2, 0};
  const double radius = 0.53 / 2 * std::numbers::pi / 180,
               solid_angle = 2 * std::numbers::pi * (1 - std::cos(radius));
  EXPECT_NEAR(seen(scene), 3 * std::numbers::pi / solid_angle, 0.01 * 3 * std::numbers::pi / solid_angle);
}

// Directions to a very small sun are rounded, and still find it, also where they are looked up because an
// environment overlaps it.
TEST(LightTransport, TinySunsKeepTheirLight) {
  auto dim = std::make_shared<EnvironmentPicture>();
  dim->width = 4, dim->height = 2;
  dim->pixels.assign(8, {1e-3f, 1e-3f, 1e-3f});
  for (const double angle : {0.1, 1e-3, 1e-4, 1e-5, 1e-6, 1e-17, 1e-18, 1e-30}) {
    Scene scene = floor_scene(1024);
    scene.lights = {DirectionalLight{{-1, -2, 0}, {1, 3, 1}, angle}, EnvironmentLight{dim}};
    EXPECT_NEAR(seen(scene), 3 * 2 / std::sqrt(5.0) + 1e-3, 0.02) << angle;
  }
}

TEST(LightTransport, TheSkyLightsTheGroundAndIsSeen) {
  Scene scene = floor_scene(1024);
  scene.lights = {SkyLight{}};
  const double sun = static_cast<double>(sun_of(SkyLight{}).color.y);
  const double lit = seen(scene);
  EXPECT_GT(lit, 0.8 * sun);
  EXPECT_LT(lit, 1.6 * sun);
  scene.camera.at = {0, 5, 0};
  EXPECT_GT(seen(scene), 0);
  EXPECT_EQ(value(run(scene).picture, "A", 0, 0), 1);
}

// Of two thousand lamps the near one matters. Chosen with equal probability it would be met by half of one of
// 1024 samples, for an error of 140 %.
TEST(LightTransport, ManyLampsCostLittle) {
  Scene scene = floor_scene(1024);
  const std::uint32_t lamp = add_material(scene, glowing({1, 1, 1}));
  double want = 0;
  const auto add_lamp = [&](const Vec3d& center, double radius) {
    add_object(scene, SphereShape{center, radius}, lamp);
    const double square = dot(center, center);
    want += radius * radius / square * center.y / std::sqrt(square);
  };
  add_lamp({0.3, 1, 0.2}, 0.1);
  for (int i = 0; i < 2000; ++i) add_lamp({40.0 + i % 50, 10.0 + i / 400, -30.0 - i % 37}, 0.1);
  EXPECT_NEAR(seen(scene), want, 3 * deviation(scene));
  EXPECT_LT(deviation(scene), 0.06 * want);
}

TEST(LightTransport, PicturesDependNeitherOnThreadsNorTilesNorSets) {
  Scene scene = bare_scene(24);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = 5, scene.integrator.depth = 5;
  scene.camera.from = {0, 2, 6};
  Material floor = diffuse({0.7f, 0.6f, 0.5f});
  floor.specular = 0.2f;
  add_object(scene, PlaneShape{{0, 1, 0}, -1}, add_material(scene, floor));
  Material metal = diffuse({1, 0.8f, 0.4f});
  metal.principled.emplace();
  metal.principled->parameters.metallic = 0.7f, metal.principled->parameters.coat = 0.5f;
  metal.principled->parameters.sheen = 0.3f;
  add_object(scene, SphereShape{{-1, 0, 0}, 0.8}, add_material(scene, metal));
  metal.principled->parameters.metallic = 0, metal.principled->parameters.transmission = 0.8f;
  add_object(scene, SphereShape{{1, 0, 0}, 0.8}, add_material(scene, metal));
  const std::uint32_t lamp = add_material(scene, glowing({9, 8, 7}));
  add_object(scene, SphereShape{{0, 3, 1}, 0.2}, lamp);
  add_object(scene, MeshShape{parallelogram({2, 2, 0}, {1, 0, 0}, {0, 1, 1}), {}, false}, lamp);
  scene.lights = {PointLight{{2, 3, 3}, {1, 1, 1}, true},
                  SpotLight{{-2, 3, 0}, {1, -2, 0}, {5, 5, 9}, 10, 30}, SkyLight{}};
  const Picture first = run(scene).picture;
  for (const Isa isa : available_isas())
    for (const unsigned threads : {1u, 3u})
      for (const std::uint32_t tile : {5u, 32u})
        EXPECT_TRUE(same_bytes(first, run(scene, [&](RenderOptions& o) {
                                        o.isa = isa, o.threads = threads, o.tile_size = tile;
                                      }).picture));
}

}  // namespace
}  // namespace oktett::light_transport_test
