#include <gtest/gtest.h>

#include <cmath>

#include "tests/render/test_scenes.h"

namespace oktett::path_test {
namespace {

using namespace test;

Scene path_scene(std::uint32_t size, std::uint32_t samples, std::uint32_t depth) {
  Scene scene = bare_scene(size);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = samples;
  scene.integrator.depth = depth;
  return scene;
}

double mean(const Picture& p, const char* plane) {
  double sum = 0;
  for (const float v : p.find(plane)->values) sum += static_cast<double>(v);
  return sum / static_cast<double>(p.find(plane)->values.size());
}

// In a closed room whose walls reflect half of the light and emit one half, the light everywhere is emission
// / (1 - albedo).
TEST(Path, FurnaceKeepsItsEnergy) {
  for (const float albedo : {0.0f, 0.2f, 0.5f, 0.8f}) {
    Scene scene = path_scene(8, 64, 64);
    scene.camera.from = {0.3, 0.2, 0.5};
    Material m = diffuse({albedo, albedo, albedo});
    m.emission = {1 - albedo, 1 - albedo, 1 - albedo};
    add_object(scene, BoxShape{}, add_material(scene, m));
    add_object(scene, SphereShape{{-0.4, -0.4, -0.4}, 0.3}, 0);
    EXPECT_NEAR(mean(run(scene).picture, "R"), 1, 0.02) << albedo;
  }
}

// The same with a room of every material: mirrors and glass in it neither add nor lose light.
TEST(Path, MirrorsAndGlassKeepTheEnergyOfTheFurnace) {
  Scene scene = path_scene(8, 256, 64);
  scene.camera.from = {0.3, 0.2, 0.9};
  Material wall = diffuse({0.5f, 0.5f, 0.5f});
  wall.emission = {0.5f, 0.5f, 0.5f};
  add_object(scene, BoxShape{}, add_material(scene, wall));
  add_object(scene, SphereShape{{-0.4, -0.4, -0.4}, 0.4}, add_material(scene, glass(1.5f)));
  add_object(scene, SphereShape{{0.4, -0.4, -0.3}, 0.4}, add_material(scene, mirror()));
  // All three in one, emitting what it does not pass on.
  Material mixed = glass(1.5f);
  mixed.diffuse = 0.3f, mixed.reflection = 0.4f, mixed.transparency = 0.2f,
  mixed.emission = {0.1f, 0.1f, 0.1f};
  add_object(scene, SphereShape{{0, 0.5, -0.4}, 0.4}, add_material(scene, mixed));
  EXPECT_NEAR(mean(run(scene).picture, "R"), 1, 0.02);
}

// Inside of a glowing mirror ball the light is the sum of what all reflections show, whether Russian roulette
// ends few paths or most of them.
TEST(Path, MirrorsThatTakeLightAwayShowTheSumOfTheirReflections) {
  for (const float kept : {0.05f, 0.3f, 0.7f, 1.0f}) {
    constexpr int kDepth = 7;
    Scene scene = path_scene(16, 256, kDepth);
    scene.camera.from = {0.2, 0.1, 0.3};
    Material m = mirror();
    m.reflection = kept, m.emission = {1, 1, 1};
    add_object(scene, SphereShape{{0, 0, 0}, 1}, add_material(scene, m));
    double sum = 0, part = 1;
    for (int k = 0; k <= kDepth + 1; ++k, part *= static_cast<double>(kept)) sum += part;
    EXPECT_NEAR(mean(run(scene).picture, "R"), sum, 0.005 * sum) << kept;
  }
}

// A convex body sees nothing but the void: it shows exactly albedo times background, without any noise in the
// mean.
TEST(Path, ConvexBodyInAWhiteVoidShowsItsAlbedo) {
  Scene scene = path_scene(8, 16, 4);
  scene.background = {1, 1, 1};
  add_object(scene, SphereShape{{0, 0, 0}, 1}, add_material(scene, diffuse({0.6f, 0.3f, 0.1f})));
  const Color c = color(run(scene).picture, 4, 4);
  EXPECT_NEAR(length(c - Color{0.6f, 0.3f, 0.1f}), 0, 1e-5f);
}

// Without indirect light both integrators show the same.
TEST(Path, DirectLightAgreesWithWhitted) {
  Scene scene = path_scene(24, 1, 0);
  Material m = diffuse({0.7f, 0.5f, 0.3f});
  m.specular = 0.3f;
  const std::uint32_t material = add_material(scene, m);
  add_object(scene, PlaneShape{{0, 1, 0}, -1}, material);
  add_object(scene, SphereShape{}, material);
  const auto expect_same = [&](std::uint32_t samples, double tolerance) {
    scene.integrator.kind = IntegratorKind::whitted;
    const Picture whitted = run(scene).picture;
    scene.integrator.kind = IntegratorKind::path;
    scene.integrator.samples = samples;
    const Picture path = run(scene).picture;
    scene.integrator.samples = 1;
    double most = 0;
    for (const char* plane : {"R", "G", "B"})
      for (std::size_t i = 0; i < path.find(plane)->values.size(); ++i)
        most = std::max(most, std::abs(static_cast<double>(path.find(plane)->values[i]) -
                                       static_cast<double>(whitted.find(plane)->values[i])));
    EXPECT_LT(most, tolerance);
  };
  const std::vector<Light> lights = {PointLight{{2, 4, 3}, {1, 1, 1}, true},
                                     PointLight{{2, 4, 3}, {0.3f, 0.2f, 0.1f}, false},
                                     DirectionalLight{{1, -1, -1}, {0.5f, 0.5f, 0.5f}},
                                     SpotLight{{1, 5, 2}, {-1, -5, -2}, {9, 8, 7}, 10, 20}};
  // One light is always chosen, so a sample has no error; of several each is, in proportion to its light.
  for (const Light& light : lights) {
    scene.lights = {light};
    expect_same(1, 1e-5);
  }
  scene.lights = lights;
  scene.camera.projection = Projection::orthographic;
  scene.film.width = scene.film.height = 1, scene.camera.height = 0.001;
  expect_same(65536, 0.01);
}

/// The mean over the picture, and its standard deviation.
struct Mean {
  double value = 0, deviation = 0;
};

Mean mean_of(const Picture& p) {
  Mean m;
  const auto &green = p.find("G")->values, &variance = p.find("Variance.G")->values;
  for (std::size_t i = 0; i < green.size(); ++i)
    m.value += static_cast<double>(green[i]), m.deviation += static_cast<double>(variance[i]);
  const auto count = static_cast<double>(green.size());
  m.value /= count, m.deviation = std::sqrt(m.deviation) / count;
  return m;
}

// Light samples at rough glass find the lamp behind it, so no other light may pass it straight. A point and
// parallel light must therefore light a room below a pane as a ball and a small sun do, which pass no glass
// straight.
TEST(Path, LightsWithoutSizePassRoughGlassOnce) {
  Scene scene = path_scene(8, 2048, 6);
  scene.camera.from = {0, 1.5, 4}, scene.camera.at = {0, -1, 0}, scene.camera.fov = 20;
  const std::uint32_t wall = add_material(scene, diffuse({0.5f, 0.5f, 0.5f}));
  add_object(scene, BoxShape{{-5, -2, -5}, {5, -1, 5}}, wall);
  add_object(scene, BoxShape{{-5, 1.9, -5}, {5, 2, 5}}, add_material(scene, {}));
  Material& pane = scene.materials.back();
  for (const bool thin : {false, true})
    for (const float roughness : {0.5f, 1.0f})
      for (const bool distant : {false, true}) {
        pane = Material{};
        pane.principled = PrincipledMaterial{};
        PrincipledParameters& p = pane.principled->parameters;
        p.base_color = {1, 1, 1}, p.transmission = 1, p.roughness = roughness, p.thin = thin;
        resemble_principled(pane);
        const auto direction = Vec3d{0.2, -1, 0.1};
        if (distant)
          scene.lights = {DirectionalLight{direction, {1, 1, 1}}};
        else
          scene.lights = {PointLight{{0.5, 4, 0}, {4, 4, 4}, true}};
        const Mean sharp = mean_of(run(scene).picture);
        Scene soft = scene;
        soft.lights.clear();
        if (distant)
          soft.lights = {DirectionalLight{direction, {1, 1, 1}, 3}};
        else
          add_object(soft, SphereShape{{0.5, 4, 0}, 0.2}, add_material(soft, glowing({100, 100, 100})));
        const Mean wide = mean_of(run(soft).picture);
        const double noise = std::hypot(sharp.deviation, wide.deviation);
        EXPECT_LT(noise, 0.05 * wide.value);
        EXPECT_NEAR(sharp.value, wide.value, 4 * noise) << thin << ' ' << roughness << ' ' << distant;
      }
}

// Where rough glass touches solids of its own index it neither bends nor scatters light. Direct light alone.
TEST(Path, LightsWithoutSizePassRoughGlassAmongItsLike) {
  Scene scene = path_scene(8, 64, 0);
  scene.camera.from = {0, 1.5, 4}, scene.camera.at = {0, -1, 0}, scene.camera.fov = 20;
  scene.lights = {PointLight{{0.5, 4, 0}, {4, 4, 4}, true}};
  add_object(scene, BoxShape{{-5, -2, -5}, {5, -1, 5}}, add_material(scene, diffuse({0.5f, 0.5f, 0.5f})));
  Material dense;
  dense.principled = PrincipledMaterial{};
  dense.principled->parameters.base_color = {1, 1, 1}, dense.principled->parameters.transmission = 1;
  dense.principled->parameters.roughness = 0;
  resemble_principled(dense);
  dense.priority = 0;
  add_object(scene, SphereShape{{0, 0, 0}, 50}, add_material(scene, dense));
  const Mean without = mean_of(run(scene).picture);
  dense.principled->parameters.roughness = 0.5f;
  dense.priority = 1;
  add_object(scene, BoxShape{{-5, 1.9, -5}, {5, 2, 5}}, add_material(scene, dense));
  const Mean with = mean_of(run(scene).picture);
  EXPECT_GT(without.value, 0.01);
  EXPECT_NEAR(with.value, without.value,
              4 * std::hypot(with.deviation, without.deviation) + 1e-3 * with.value);
}

// Light that reaches a floor only by way of a wall: one bounce, computed by quadrature over the wall.
TEST(Path, IndirectLightMatchesQuadrature) {
  Scene scene = path_scene(1, 16384, 1);
  scene.camera.from = {1, 1, 0}, scene.camera.at = {1, 0, 0}, scene.camera.up = {0, 0, 1};
  scene.camera.fov = 0.01;
  const std::uint32_t white = add_material(scene, diffuse({1, 1, 1}));
  // The wall x = 0, 0 < y < 2, |z| < 1 faces the floor y = 0; the light travels along -x, so that the floor
  // gets none of it.
  add_object(scene, BoxShape{{-0.1, 0, -1}, {0, 2, 1}}, white);
  add_object(scene, DiskShape{{1, 0, 0}, {0, 1, 0}, 0.1}, white);
  scene.lights = {DirectionalLight{{-1, 0, 0}, {1, 1, 1}}};
  double want = 0;
  constexpr int kSteps = 200;
  for (int i = 0; i < kSteps; ++i)
    for (int k = 0; k < kSteps; ++k) {
      const Vec3d q{0, 2 * (i + 0.5) / kSteps, 2 * (k + 0.5) / kSteps - 1}, d = q - Vec3d{1, 0, 0};
      const double r2 = dot(d, d);
      // The wall shows 1; form factor from the floor point: cos cos / (pi r^2) dA.
      want += (d.y * -d.x) / (r2 * r2 * std::numbers::pi) * 4 / (kSteps * kSteps);
    }
  EXPECT_NEAR(value(run(scene).picture, "R", 0, 0), want, 0.01 * want);
}

TEST(Path, DepthBoundsThePath) {
  Material m = diffuse({0.9f, 0.9f, 0.9f});
  m.emission = {0.1f, 0.1f, 0.1f};
  const auto box = [&](unsigned depth) {
    Scene scene = path_scene(4, 16, depth);
    add_object(scene, BoxShape{{-9, -9, -9}, {9, 9, 9}}, add_material(scene, m));
    return run(scene);
  };
  const RenderResult sure = box(1);
  EXPECT_EQ(sure.report.reflected_rays, 16u * 16 * 2) << "before Russian roulette begins";
  // Two surfaces scatter light, and the last one sees the emission of a third.
  EXPECT_NEAR(mean(sure.picture, "R"), 0.1 * (1 + 0.9 + 0.81), 1e-5);

  const RenderResult deep = box(6);
  EXPECT_EQ(deep.report.bounces.size(), 8u);
  double light = 0;
  for (int k = 0; k < 8; ++k) light += 0.1 * std::pow(0.9, k);
  EXPECT_NEAR(mean(deep.picture, "R"), light, 0.03 * light);
}

TEST(AmbientOcclusion, IsTheOpenFractionOfTheSky) {
  Scene scene = bare_scene(3);
  scene.integrator.kind = IntegratorKind::ao;
  scene.integrator.samples = 1024;
  scene.camera.from = {0.5, 0.5, 0}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 0.01;
  add_object(scene, PlaneShape{{0, 1, 0}, 0}, kNoId);
  scene.integrator.ao_radius = 100;
  EXPECT_NEAR(value(run(scene).picture, "R", 1, 1), 1, 1e-6f);
  // A ball of angular radius a right above hides sin^2 a of the cosine-weighted sky.
  add_object(scene, SphereShape{{0, 2, 0}, 1}, kNoId);
  EXPECT_NEAR(value(run(scene).picture, "R", 1, 1), 0.75f, 5e-3f);
  scene.integrator.ao_radius = 0.5;
  EXPECT_NEAR(value(run(scene).picture, "R", 1, 1), 1, 1e-6f);
}

TEST(Views, NormalAndDepthShowWhatTheySay) {
  Scene scene = bare_scene(33);
  add_object(scene, BoxShape{}, kNoId);
  scene.background = {0.25f, 0.5f, 0.75f};
  scene.integrator.kind = IntegratorKind::normal;
  const Picture normal = run(scene).picture;
  EXPECT_EQ(color(normal, 16, 16), (Color{0.5f, 0.5f, 1}));
  EXPECT_EQ(color(normal, 0, 0), scene.background);
  scene.integrator.kind = IntegratorKind::depth;
  // The box spans depths 4 to 6; its front is nearest.
  const Picture depth = run(scene).picture;
  EXPECT_NEAR(value(depth, "R", 16, 16), 1, 1e-6f);
  EXPECT_EQ(value(depth, "Z", 16, 16), 4);
  EXPECT_EQ(color(depth, 0, 0), scene.background);
}

}  // namespace
}  // namespace oktett::path_test
