/// \file Pictures with caustics: against closed forms, against path tracing, and their bits.

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "core/random.h"
#include "render/moments.h"
#include "render/photon/caustics.h"
#include "render/photon/photon_source.h"
#include "tests/render/photon_support.h"

namespace oktett::caustics_test {
namespace {

using namespace test;

/// A mirror ball of radius 0.02 at the origin in a parallel beam along -z, which it sends evenly in all
/// directions. Away from the light lies a white floor, y = -1, whose middle the camera sees from below the
/// light's way.
Scene ball_in_beam(std::uint32_t photons, std::uint32_t passes, double radius) {
  Scene scene = bare_scene(1);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.samples = passes, scene.integrator.depth = 3;
  scene.integrator.caustics.photons = photons, scene.integrator.caustics.passes = passes;
  scene.integrator.caustics.radius = radius;
  scene.camera.from = {3, 2, 0}, scene.camera.at = {0, -1, 0}, scene.camera.fov = 0.001;
  scene.lights = {DirectionalLight{{0, 0, -1}, {1, 1, 1}, 0}};
  add_object(scene, SphereShape{{0, 0, 0}, 0.02}, add_material(scene, mirror()));
  add_object(scene, PlaneShape{{0, 1, 0}, -1}, add_material(scene, diffuse({1, 1, 1})));
  return scene;
}

// Rough glass sends photons on where it hardly bends light, which a texture of its index may say.
TEST(Casters, RoughGlassIsOneWhereItsIndexMayBeThatOfAir) {
  Material m;
  PrincipledMaterial& p = m.principled.emplace();
  p.parameters.transmission = 1, p.parameters.ior = 2;
  EXPECT_FALSE(may_cast(m));
  p.ior_texture = 0;
  EXPECT_TRUE(may_cast(m));
  p.parameters.transmission = 0;
  EXPECT_FALSE(may_cast(m));
}

/// What the floor shows at the distance rho from its middle: irradiance pi on the ball of cross section
/// pi R^2, spread over 4 pi d^2, under the cosine 1 / d, divided by pi.
double floor_light(double rho) {
  const double square = 1 + rho * rho;
  return 0.02 * 0.02 / 4 / (square * std::sqrt(square));
}

/// The same smoothed by the kernel of a radius: the midpoint rule.
double smoothed_light(double radius) {
  const int steps = 2000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double rho = (i + 0.5) / steps;
    sum += 4 * rho * (1 - rho * rho) / steps * floor_light(rho * radius);
  }
  return sum;
}

double seen(const Scene& scene) { return static_cast<double>(value(run(scene).picture, "G", 0, 0)); }

// A ball that mirrors sends a parallel beam evenly in all directions.
TEST(Caustics, AMirrorBallInAParallelBeamMatchesItsClosedForm) {
  const double got = seen(ball_in_beam(200000, 16, 0.1));
  EXPECT_NEAR(got, floor_light(0), 0.015 * floor_light(0));
  // Without photons path tracing cannot find that light at all.
  EXPECT_EQ(seen(ball_in_beam(0, 16, 0)), 0);
}

// The bias is that of the kernel, and shrinks with the number of passes.
TEST(Caustics, TheBiasIsThatOfTheKernelAndShrinks) {
  const double truth = floor_light(0), first = 0.8;
  std::vector<double> log_got, log_want;
  for (const std::uint32_t passes : {1u, 8u, 64u}) {
    double want = 0;
    for (std::uint32_t i = 0; i < passes; ++i) want += smoothed_light(pass_radius(first, i)) / passes;
    const double got = seen(ball_in_beam(400000 / passes + 50000, passes, first));
    EXPECT_NEAR(got, want, 0.02 * truth) << passes;
    log_got.push_back(std::log(truth - got)), log_want.push_back(std::log(truth - want));
  }
  const auto slope = [](const std::vector<double>& v) { return (v[2] - v[0]) / std::log(64.0); };
  EXPECT_NEAR(slope(log_got), slope(log_want), 0.03);
  EXPECT_LT(slope(log_got), -0.17);
}

// The mean of the squares of n radii, and with it the bias, falls as n^-1/3.
TEST(Caustics, TheBiasVanishesAsTheCubeRoot) {
  const auto mean_square = [](std::uint32_t n) {
    double sum = 0, square = 1;
    for (std::uint32_t i = 1; i <= n; square *= (i + 2.0 / 3) / (i + 1.0), ++i) sum += square;
    return sum / n;
  };
  EXPECT_NEAR(mean_square(3),
              (1 + pass_radius(1, 1) * pass_radius(1, 1) + pass_radius(1, 2) * pass_radius(1, 2)) / 3, 1e-12);
  EXPECT_NEAR(std::log(mean_square(1000000) / mean_square(10000)) / std::log(100.0), -1.0 / 3, 0.002);
}

TEST(Caustics, PhotonsAndPathsFindTheSameLight) {
  CausticSettings caustics;
  caustics.photons = 20000, caustics.passes = 64;
  expect_same_light(lamp_over_glass(glass(1.5f)), caustics, 0.01);
  expect_same_light(lamp_over_glass(mirror()), caustics, 0.01);
}

// A pane of thin glass, whose other side is as dense as this one, and a smooth coat on a rough base.
TEST(Caustics, ThinGlassAndCoats) {
  CausticSettings caustics;
  caustics.photons = 20000, caustics.passes = 64;
  Material thin = diffuse({0.9f, 0.9f, 0.9f});
  thin.principled.emplace();
  thin.principled->parameters.roughness = 0, thin.principled->parameters.transmission = 1;
  thin.principled->parameters.thin = true;
  Scene scene = lamp_over_glass(thin);
  scene.objects[1].shape = DiskShape{{-0.5, 0.8, 0}, normalize(Vec3d{0.2, 1, 0.3}), 0.6};
  expect_same_light(scene, caustics, 0.01);
  Material coated = diffuse({0.3f, 0.3f, 0.3f});
  coated.principled.emplace();
  coated.principled->parameters.roughness = 0.7f, coated.principled->parameters.coat = 1;
  coated.principled->parameters.coat_roughness = 0, coated.principled->parameters.coat_ior = 2.4f;
  scene = lamp_over_glass(coated);
  expect_same_light(scene, caustics, 0.01);
}

// A coarse mesh whose shading normals are those of a ball: backwards as forwards.
TEST(Caustics, MeshesWithSmoothNormals) {
  CausticSettings caustics;
  caustics.photons = 20000, caustics.passes = 64;
  for (const Material& material : {glass(1.5f), mirror()}) {
    Scene scene = lamp_over_glass(material);
    scene.objects[1].shape =
        MeshShape{sphere_mesh(4, {-0.5, 0.7, 0}, 0.5), {}, true, TriangleTest::watertight, true};
    expect_same_light(scene, caustics, 0.01);
  }
}

// The number of bounces is bounded alike.
TEST(Caustics, PathsOfTheSameLengthAreFound) {
  CausticSettings caustics;
  caustics.photons = 20000, caustics.passes = 64;
  for (const std::uint32_t depth : {0u, 1u, 2u}) {
    Scene scene = lamp_over_glass(glass(1.5f));
    scene.integrator.depth = depth;
    expect_same_light(scene, caustics, 0.01);
  }
}

// In a floor within glass, where photons and radiance are divided by the square of the index, under a sky.
TEST(Caustics, SurfacesWithinGlassAndSkies) {
  Scene scene = bare_scene(12);
  scene.integrator.kind = IntegratorKind::path;
  scene.integrator.depth = 6;
  scene.camera.from = {0, 3, 4}, scene.camera.at = {0, 0, 0}, scene.camera.fov = 30;
  add_object(scene, BoxShape{{-1, -1, -1}, {1, 0.5, 1}}, add_material(scene, glass(1.5f)));
  add_object(scene, DiskShape{{0, 0, 0}, {0, 1, 0}, 0.7}, add_material(scene, diffuse({0.7f, 0.7f, 0.7f})));
  auto picture = std::make_shared<EnvironmentPicture>();
  picture->width = 8, picture->height = 4;
  for (int i = 0; i < 32; ++i) picture->pixels.push_back({1, i < 16 ? 2.0f : 0.3f, 1});
  scene.lights = {EnvironmentLight{picture, 0, {1, 1, 1}}};
  CausticSettings caustics;
  caustics.photons = 20000, caustics.passes = 64;
  expect_same_light(scene, caustics, 0.01);
}

// At each moment, and in every cycle of samples, the samples of a pixel ask one pass of the moment after the
// other.
TEST(Caustics, SamplesOfAMomentAskItsPassesInTurn) {
  constexpr std::uint32_t kPasses = 16;
  for (const auto& [moments, cycle] : {std::pair{4u, 4u}, std::pair{3u, 8u}, std::pair{1u, 5u}})
    for (std::uint32_t m = 0; m < moments; ++m) {
      PassRange range{.first = m, .step = moments, .count = (kPasses - m + moments - 1) / moments};
      range.cycle = cycle, range.begin = first_sample_of_moment(m, moments, cycle);
      const std::uint32_t end = first_sample_of_moment(m + 1, moments, cycle);
      range.asking = end - range.begin;
      std::uint32_t asked = 0;
      for (std::uint32_t sample = 0; sample < 20 * cycle; ++sample) {
        if (sample % cycle < range.begin || sample % cycle >= end) continue;
        EXPECT_EQ(range.pass(1, sample), m + moments * (asked++ % range.count)) << sample;
      }
      EXPECT_GE(asked, 20u);
    }
}

// From a random place on, all passes are asked equally often.
TEST(Caustics, RandomFirstPassesAreSpreadEvenly) {
  PassRange range{.first = 1, .step = 2, .count = 8};
  range.at_random = true;
  int counts[17] = {};
  for (std::uint64_t key = 0; key < 8000; ++key) {
    const std::uint32_t first = range.pass(mix_bits(key), 0);
    ++counts[first];
    EXPECT_EQ(range.pass(mix_bits(key), 3), 1 + (first - 1 + 6) % 16);
  }
  for (int pass = 1; pass < 17; pass += 2) EXPECT_NEAR(counts[pass], 1000, 130) << pass;
}

TEST(Caustics, TheSameBitsForAllThreadsAndInstructionSets) {
  Scene scene = lamp_over_glass(glass(1.5f));
  scene.lights = {PointLight{{1, 3, 1}, {1, 1, 1}, true}, SkyLight{}};
  scene.integrator.samples = 8;
  scene.integrator.caustics.photons = 10000, scene.integrator.caustics.passes = 4;
  const Picture one = run(scene, [](RenderOptions& o) { o.threads = 1; }).picture;
  EXPECT_TRUE(same_bytes(one, run(scene, [](RenderOptions& o) { o.threads = 3; }).picture));
  EXPECT_TRUE(same_bytes(one, run(scene, [](RenderOptions& o) { o.isa = Isa::scalar; }).picture));
  for (const float v : one.find("G")->values) EXPECT_TRUE(std::isfinite(v));
}

TEST(Caustics, GivenPhotonsMustBeForTheSceneButNotForTheCamera) {
  Scene scene = lamp_over_glass(glass(1.5f));
  scene.integrator.samples = 4;
  scene.integrator.caustics.photons = 5000, scene.integrator.caustics.passes = 8;
  const auto keep = [](RenderOptions& o) { o.keep_photons = true; };
  const RenderResult made = run(scene, keep);
  ASSERT_NE(made.photons, nullptr);
  EXPECT_EQ(made.photons->passes.size(), 8u);
  const auto give = [&](RenderOptions& o) { o.photons = made.photons; };
  EXPECT_TRUE(same_bytes(made.picture, run(scene, give).picture));
  Scene other = scene;
  other.camera.from = {1, 3, 4}, other.film.width = 20, other.integrator.samples = 2;
  EXPECT_TRUE(same_bytes(run(other, keep).picture, run(other, give).picture));

  const auto expect_refused = [&](Scene changed, const char* what) {
    try {
      run(changed, give);
      ADD_FAILURE() << "accepted: " << what;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << e.what();
    }
  };
  other = scene, other.integrator.caustics.photons = 5001;
  expect_refused(other, "photons per pass: 5000, the scene wants 5001");
  other = scene, other.integrator.caustics.passes = 9;
  expect_refused(other, "passes: 8");
  other = scene, other.integrator.depth = 4;
  expect_refused(other, "depth 5, the scene wants 4");
  other = scene, other.integrator.seed = 1;
  expect_refused(other, "seed");
  other = scene, other.integrator.caustics.radius = 0.25;
  expect_refused(other, "radius 0, the scene wants 0.25");
  other = scene, other.objects[1].shape = SphereShape{{-0.5, 0.7, 0}, 0.5001};
  expect_refused(other, "geometry");
  other = scene, other.materials[3].emission = {4, 4, 4.001f};
  expect_refused(other, "lights");
  other = scene, other.materials[1].ior = 1.5001f;
  expect_refused(other, "materials");
}

TEST(Caustics, ScenesWithoutLightMirrorsOrPhotonsAreFine) {
  Scene scene = lamp_over_glass(diffuse({1, 1, 1}));
  scene.materials[2].reflection = 0;
  scene.integrator.samples = 4;
  const Picture plain = run(scene).picture;
  scene.integrator.caustics.photons = 1000;
  EXPECT_TRUE(same_bytes(plain, run(scene).picture));
  scene = lamp_over_glass(glass(1.5f));
  scene.objects.pop_back();
  scene.integrator.samples = 4;
  scene.integrator.caustics.photons = 1;
  EXPECT_EQ(value(run(scene).picture, "G", 6, 6), 0);
}

}  // namespace
}  // namespace oktett::caustics_test
